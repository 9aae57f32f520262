"""Hide effects in a motor: draw their numbers in turn, and keep the motor without them beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

from numpy.random import Generator

from nxt_twin.blind.bench import draw_motor
from nxt_twin.blind.effects.concealed import ConcealedEffect, Draw, Situation
from nxt_twin.blind.effects.library import EFFECTS, compatible
from nxt_twin.blind.kinds import SIZES, Size
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands, true_run
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.errors import CaseError


@final
@dataclass(frozen=True)
class ConcealedMotor:
    """A motor and its measuring chain with effects in them.

    Attributes:
        motor: with the effects, apart from what differs between recordings.
        sensing: with the effects.
        plain: the same motor without them; its measuring chain is perfect.
        by_recording: fields of `motor` that differ, one mapping a recording.
        effects: what the answer says of each effect.
    """

    motor: Motor
    sensing: Sensing
    plain: Motor
    by_recording: tuple[Mapping[str, float], ...]
    effects: tuple[Mapping[str, Any], ...] = ()

    def motor_in(self, recording: int) -> Motor:
        """The motor as it is in one of the recordings."""
        return replace(self.motor, **self.by_recording[recording])

    def plus(self, effect: ConcealedEffect, size: Size, draw: Draw) -> ConcealedMotor:
        """The same with one more effect."""
        extra = draw.by_recording or ({},) * len(self.by_recording)
        listed = {
            "id": effect.id,
            "known": effect.known,
            "size": size,
            "main": next(iter(draw.params)),
            "params": dict(draw.params),
        }
        return ConcealedMotor(
            motor=replace(self.motor, **draw.motor),
            sensing=replace(self.sensing, **draw.sensing),
            plain=replace(self.plain, **draw.absent),
            by_recording=tuple(
                {**before, **new} for before, new in zip(self.by_recording, extra, strict=True)
            ),
            effects=(*self.effects, listed),
        )


def look_up(ids: tuple[str, ...]) -> tuple[ConcealedEffect, ...]:
    """The effects of these ids, in the order in which they are drawn.

    Raises:
        CaseError: for an id that is not known here, or for two that cannot stand together.
    """
    for effect_id in ids:
        if effect_id not in EFFECTS:
            raise CaseError(f"no effect {effect_id!r} to hide", mend=f"choose from {', '.join(EFFECTS)}")
    if not compatible(ids):
        raise CaseError(f"{', '.join(ids)} cannot stand in one case", mend="hide one of them")
    return tuple(effect for effect_id, effect in EFFECTS.items() if effect_id in ids)


def conceal(
    rng: Generator,
    effects: tuple[ConcealedEffect, ...],
    size: Size | None,
    commands: Sequence[Commands],
    duration_s: float,
) -> ConcealedMotor:
    """Draw a motor, then each effect's numbers; `size` None draws a size for each."""
    motor = draw_motor(rng)
    hidden = ConcealedMotor(motor, Sensing(), motor, ({},) * len(commands))
    for effect in effects:
        drawn_size: Size = size or SIZES[int(rng.integers(len(SIZES)))]
        situation = Situation(
            rng=rng,
            size=drawn_size,
            motor=hidden.motor,
            recordings=len(commands),
            duration_s=duration_s,
            starts_deg=tuple(run.start_deg for run in commands),
            reach_deg=_reach_deg(hidden, commands) if effect.needs_reach else (),
        )
        hidden = hidden.plus(effect, drawn_size, effect.sample(situation))
    return hidden


def _reach_deg(hidden: ConcealedMotor, commands: Sequence[Commands]) -> tuple[tuple[float, float], ...]:
    runs = [true_run(hidden.motor_in(k), hidden.sensing, run).hub_deg for k, run in enumerate(commands)]
    return tuple((float(hub_deg.min()), float(hub_deg.max())) for hub_deg in runs)
