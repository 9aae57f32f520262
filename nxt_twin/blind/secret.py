"""The effect that a mock brick conceals in one of its motors: drawn from a seed, or written in a file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Final, final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from nxt_twin.blind.conceal import ConcealedMotor, look_up
from nxt_twin.blind.effects.concealed import ConcealedEffect, Situation
from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.kinds import SIZES, Size
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.errors import CaseError
from nxt_twin.recording.columns import Port
from nxt_twin.recording.yaml_file import read_model

ONLY_IN_RECORDINGS: Final = ("clock_skew", "stale_samples", "amplifier_memory")
"""They are made of a whole recording's stamps or commands, which a brick that runs does not have."""

_SEED: Final = re.compile(r"[0-9]{1,18}")
_ABOUT_S: Final = 60.0
"""The time that a person watches: what comes on, warms up or drains does so within it."""
_REACH_DEG: Final = 720.0
"""How far the motor is supposed to go either way, for a stop to be met."""


@final
@dataclass(frozen=True)
class Secret:
    """A motor with something concealed in it; without it, it is the motor that every plant file describes.

    Attributes:
        port: of the mock brick.
        motor: with the effects.
        sensing: its delay and its encoder's faults.
        effects: what the answer says of each effect; empty where nothing is concealed.
    """

    port: Port
    motor: Motor
    sensing: Sensing
    effects: tuple[Mapping[str, Any], ...]

    def revealed(self) -> dict[str, Any]:
        """All of it, to be shown when the guessing is over."""
        plain = Motor()
        numbers = {field.name: getattr(self.motor, field.name) for field in fields(Motor)}
        moved = {name: value for name, value in numbers.items() if value != getattr(plain, name)}
        return {"port": self.port, "effects": [dict(effect) for effect in self.effects], "motor": moved}


@final
class SecretFile(BaseModel):
    """A file that says what to conceal.

    Attributes:
        port: the motor in which it is.
        effects: ids; without any, what `seed` draws, unless `motor` says something.
        size: how large; drawn where left out.
        seed: of the effects' numbers.
        motor: fields of the true motor, set at the end as they stand.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    port: Port = "a"
    effects: tuple[str, ...] | None = None
    size: Size | None = None
    seed: int = Field(default=0, ge=0)
    motor: dict[str, float] = Field(default_factory=dict)


def concealed(
    seed: int, *, effects: tuple[str, ...] | None = None, size: Size | None = None, port: Port = "a"
) -> Secret:
    """Draw the concealed effects; equal arguments draw equal effects.

    Args:
        seed: of the effect, its size and its numbers.
        effects: ids to conceal; None draws one that is missing from a plain motor, `()` conceals nothing.
        size: how large; None draws it.
        port: the motor in which it is.

    Raises:
        CaseError: for an effect that is not known here, that only a recording can have, or for two that cannot
            stand together.
    """
    rng = np.random.default_rng(seed)
    chosen = (str(rng.choice(drawable())),) if effects is None else effects
    for name in set(chosen) & set(ONLY_IN_RECORDINGS):
        mend = "make it with nxt-twin blind make"
        raise CaseError(f"{name} can be concealed in recordings, not in a mock brick", mend=mend)
    motor = Motor()
    hidden = ConcealedMotor(motor, Sensing(), motor, ({},))
    for effect in look_up(chosen):
        drawn: Size = size or SIZES[int(rng.integers(len(SIZES)))]
        hidden = hidden.plus(effect, drawn, effect.sample(_situation(rng, drawn, hidden.motor)))
    return Secret(port, hidden.motor_in(0), hidden.sensing, hidden.effects)


def drawable() -> list[str]:
    """The ids that a seed draws from: those of docs/effects.md that a plain motor lacks."""
    return [effect.id for effect in KNOWN_EFFECTS.values() if _lacking(effect)]


def read_secret(file: Path) -> Secret:
    """Read a file that says what to conceal.

    Raises:
        CaseError: it is none, or as with `concealed`.
    """
    said = read_model(file, SecretFile, CaseError)
    unknown = set(said.motor) - {field.name for field in fields(Motor)}
    if unknown:
        raise CaseError(f"a motor has no {', '.join(sorted(unknown))}", where=f"{file}, key motor")
    effects = () if said.effects is None and said.motor else said.effects
    secret = concealed(said.seed, effects=effects, size=said.size, port=said.port)
    return replace(secret, motor=replace(secret.motor, **said.motor))


def secret_of(text: str) -> Secret:
    """The secret that a user wrote as a seed, or as a file's path.

    Raises:
        CaseError: as with `concealed` and `read_secret`.
    """
    return concealed(int(text)) if _SEED.fullmatch(text) else read_secret(Path(text))


def _lacking(effect: ConcealedEffect) -> bool:
    return effect.leaves_out is None and effect.id not in ONLY_IN_RECORDINGS


def _situation(rng: np.random.Generator, size: Size, motor: Motor) -> Situation:
    return Situation(
        rng=rng,
        size=size,
        motor=motor,
        recordings=1,
        duration_s=_ABOUT_S,
        starts_deg=(0.0,),
        reach_deg=((-_REACH_DEG, _REACH_DEG),),
    )
