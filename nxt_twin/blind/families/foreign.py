"""Make a case of a foreign family: draw a motor and a host, hide effects, record, keep the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.case import ConcealedCase, rms
from nxt_twin.blind.families.beginnings import BeginningName, draw_beginning, draw_kind
from nxt_twin.blind.families.habits import Habits, draw_habits, draw_length_s, polls_s
from nxt_twin.blind.families.host import Driven, Rows, Script, drive_machine, follow, shown_deg, write_rows
from nxt_twin.blind.families.machine import Machine
from nxt_twin.blind.families.motors import draw_baseline, draw_motor, true_parameters
from nxt_twin.blind.families.numbers import Chain, Numbers
from nxt_twin.blind.families.packets import draw_packets, handed_over
from nxt_twin.blind.families.programs import PROGRAMS, Program, draw_programs
from nxt_twin.blind.families.setting import DrawnCase, Hideable
from nxt_twin.blind.kinds import SIZES, Size
from nxt_twin.errors import CaseError
from nxt_twin.recording.recording import Recording

ANSWER_SCHEMA: Final = "nxt-twin/answer/1"
HOLDOUT_CHANCE: Final = 0.5
FEWEST_TO_HOLD_OUT: Final = 2
SALT_BYTES: Final = 16

Build = Callable[[Numbers, float, float], Machine]


@final
@dataclass(frozen=True)
class Foreign:
    """The parts of a foreign family.

    Attributes:
        name: of the family.
        build: makes its machine of a motor, a start angle in rad, and the time at which it begins in s.
        effects: what it can hide, those that look at the others last.
        longest_s: what all recordings of a case may last together, s.
        steps_deg: the encoders, one of which is drawn.
        command_every_s: the least time between two commands, s.
    """

    name: str
    build: Build
    effects: tuple[Hideable, ...]
    longest_s: float = 300.0
    steps_deg: tuple[float, ...] = (1.0, 1.0, 1.0, 0.5, 0.25, 0.1)
    command_every_s: float = 0.0

    def chosen(self, ids: Sequence[str]) -> tuple[Hideable, ...]:
        """The effects of these ids, in the order of drawing.

        Raises:
            CaseError: for an id that the family cannot hide, or for two that cannot stand together.
        """
        for one in ids:
            if one not in {effect.id for effect in self.effects}:
                mend = f"choose from {', '.join(effect.id for effect in self.effects)}"
                raise CaseError(f"the family {self.name} has no effect {one!r} to hide", mend=mend)
        found = tuple(effect for effect in self.effects if effect.id in ids)
        if len(found) != len(ids) or not stand_together(found):
            raise CaseError(f"{', '.join(ids)} cannot stand in one case", mend="hide one of them")
        return found


def stand_together(effects: Sequence[Hideable]) -> bool:
    """Whether these can stand in one case: no two clash, and one stranger at most."""
    ids = {effect.id for effect in effects}
    return (
        all(ids.isdisjoint(effect.clashes) for effect in effects)
        and sum(not one.known for one in effects) < 2
    )


@final
@dataclass(frozen=True)
class _Hiding:
    """A motor with what is hidden in it, and the same motor without."""

    motor: Numbers
    chain: Chain
    plain: Numbers
    by_recording: tuple[Mapping[str, float], ...]
    effects: tuple[Mapping[str, Any], ...] = ()

    def motor_in(self, recording: int) -> Numbers:
        return replace(self.motor, **self.by_recording[recording])

    def plus(self, effect: Hideable, at: DrawnCase) -> _Hiding:
        drawn = effect.draw(at)
        extra = drawn.by_recording or ({},) * len(self.by_recording)
        listed = {
            "id": effect.id,
            "known": effect.known,
            "equation": effect.equation,
            "size": at.size,
            "main": next(iter(drawn.params)),
            "params": dict(drawn.params),
        }
        return _Hiding(
            replace(self.motor, **drawn.numbers),
            replace(self.chain, **drawn.chain),
            replace(self.plain, **drawn.absent),
            tuple({**old, **new} for old, new in zip(self.by_recording, extra, strict=True)),
            (*self.effects, listed),
        )


def make_foreign(
    family: Foreign,
    seed: int,
    effects: Sequence[str],
    size: Size | None,
    *,
    name: str,
    duration_s: float | None = None,
) -> ConcealedCase:
    """Make one case of a family; the same arguments make the same case.

    Args:
        family: of which.
        seed: of all chance in the case.
        effects: ids to hide; none for a clean case.
        size: how large; None draws a size for each.
        name: of the case.
        duration_s: of each recording; None draws it.

    Raises:
        CaseError: for effects that the family cannot hide.
    """
    rng = np.random.default_rng(seed)
    to_hide = family.chosen(effects)
    least = max((effect.least_recordings for effect in to_hide), default=1)
    habits = draw_habits(
        rng, family.steps_deg, longest_s=family.longest_s, duration_s=duration_s, least_recordings=least
    )
    programs = draw_programs(rng, habits.recordings, coasts=any(effect.coasts for effect in to_hide))
    scripts = draw_scripts(rng, habits, programs, draw_kind(rng), family.command_every_s)
    hiding = _hide(rng, family, to_hide, size, habits, scripts)
    driven = [_driven(family, hiding, k, script, habits) for k, script in enumerate(scripts)]
    rows = [
        write_rows(rng, script, hiding.chain, habits, one)
        for script, one in zip(scripts, driven, strict=True)
    ]
    content = _content(rng, draw_baseline(rng, hiding.motor), to_hide, [script.name for script in scripts])
    shifts = [_shift_deg(family, hiding, scripts[k], driven[k], rows[k]) for k in range(len(scripts))]
    answer = {
        "schema": ANSWER_SCHEMA,
        "case": name,
        "family": family.name,
        "seed": seed,
        "rate_hz": habits.rate_hz,
        "step_deg": habits.step_deg,
        "effects": list(hiding.effects),
        "base": true_parameters(hiding.motor),
        "baseline": content["plant"],
        **_truth_of(scripts, rows, shifts),
        "salt": rng.bytes(SALT_BYTES).hex(),
    }
    sidecar = {} if habits.step_deg == 1.0 else {"tacho_step_deg": habits.step_deg}
    recordings = _over_link(seed, habits, effects, [one.recording for one in rows])
    return ConcealedCase(name, content, recordings, answer, sidecar)


def _over_link(
    seed: int, habits: Habits, effects: Sequence[str], recordings: Sequence[Recording]
) -> tuple[Recording, ...]:
    """As the host gets them; chance of its own, so that a case differs in nothing but its stamps."""
    rng = np.random.default_rng([seed, *b"link"])
    packets = draw_packets(rng, habits, effects)
    return tuple(handed_over(rng, one, packets) if packets else one for one in recordings)


def _truth_of(
    scripts: Sequence[Script], rows: Sequence[Rows], shifts: Sequence[FloatArray]
) -> dict[str, Any]:
    """The true angle of each recording, and by how much (RMS) the effects moved the reading."""
    recordings = {
        script.name: {
            "family": script.program,
            "begins": script.begins,
            "effect_rms_deg": rms(shift),
            "hub_deg": [round(float(angle), 3) for angle in one.hub_deg],
        }
        for script, shift, one in zip(scripts, shifts, rows, strict=True)
    }
    return {"effect_rms_deg": rms(np.concatenate(shifts)), "recordings": recordings}


def draw_scripts(
    rng: Generator,
    habits: Habits,
    programs: Sequence[str],
    begins: BeginningName,
    command_every_s: float,
) -> tuple[Script, ...]:
    """A script for each program, of recordings `r1.csv` and so on."""
    far = rng.random() < 0.5
    scripts = []
    for number, program in enumerate(programs, start=1):
        loops = program.endswith("_loop") and habits.poll_s < command_every_s
        polled = replace(habits, rate_hz=1.0 / command_every_s) if loops else habits
        start_deg = float(rng.uniform(-360.0, 360.0) if far else rng.random())
        beginning, length_s = draw_beginning(rng, begins), draw_length_s(rng, habits)
        seed = int(rng.integers(2**31))
        scripts.append(
            Script(
                name=f"r{number}.csv",
                program=program,
                begins=begins,
                read_s=polls_s(rng, polled, length_s, beginning.before_s),
                start_deg=start_deg,
                ahead_s=beginning.ahead_s,
                make_program=partial(
                    _program, program, seed, length_s + beginning.before_s + beginning.ahead_s
                ),
            )
        )
    return tuple(scripts)


def _program(name: str, seed: int, duration_s: float) -> Program:
    return PROGRAMS[name](np.random.default_rng(seed), duration_s)


def _hide(
    rng: Generator,
    family: Foreign,
    effects: tuple[Hideable, ...],
    size: Size | None,
    habits: Habits,
    scripts: tuple[Script, ...],
) -> _Hiding:
    motor = draw_motor(rng)
    hiding = _Hiding(motor, Chain(), motor, ({},) * len(scripts))
    for effect in effects:
        reach = _reach_deg(family, hiding, scripts, habits) if effect.id == "end_stop" else ()
        at = DrawnCase(
            rng=rng,
            size=size or SIZES[int(rng.integers(len(SIZES)))],
            motor=hiding.motor,
            recordings=len(scripts),
            duration_s=habits.duration_s,
            poll_s=habits.poll_s,
            starts_deg=tuple(script.start_deg for script in scripts),
            reach_deg=reach,
        )
        hiding = hiding.plus(effect, at)
    return hiding


def _reach_deg(
    family: Foreign, hiding: _Hiding, scripts: tuple[Script, ...], habits: Habits
) -> tuple[tuple[float, float], ...]:
    reach = []
    for number, script in enumerate(scripts):
        hub = np.rad2deg(_driven(family, hiding, number, script, habits).states[:, 0])
        shown = hub[script.read_s >= 0.0]
        reach.append((float(shown.min()), float(shown.max())))
    return tuple(reach)


def _driven(family: Foreign, hiding: _Hiding, number: int, script: Script, habits: Habits) -> Driven:
    machine = _machine(family, hiding.motor_in(number), script)
    return drive_machine(machine, hiding.chain, script, habits.step_deg, family.command_every_s)


def _machine(family: Foreign, motor: Numbers, script: Script) -> Machine:
    return family.build(motor, float(np.deg2rad(script.start_deg)), float(script.read_s[0]))


def _shift_deg(family: Foreign, hiding: _Hiding, script: Script, driven: Driven, rows: Rows) -> FloatArray:
    """Reading with the effects minus that of the same motor without them under the same commands."""
    if not hiding.effects:
        return np.zeros(script.read_s.size)
    plain = _machine(family, hiding.plain, script)
    table = _as_written(hiding.chain, driven)
    read_deg = shown_deg(Chain(), follow(plain, Chain(), script, *table))
    return rows.read_deg - np.interp(rows.recording.time_s, script.read_s, read_deg)


def _as_written(chain: Chain, driven: Driven) -> tuple[Any, Any]:
    """The commands in the rows into which they are written."""
    late = int(chain.late_rows)
    duty = np.concatenate([np.zeros(late), driven.duty_pct])[: driven.duty_pct.size]
    return duty, np.concatenate([np.zeros(late, dtype=np.int64), driven.mode])[: driven.mode.size]


def _content(
    rng: Generator, baseline: Mapping[str, float], effects: tuple[Hideable, ...], names: list[str]
) -> dict[str, Any]:
    left_out = {effect.leaves_out for effect in effects}
    plant = {"kind": "dc_motor", **{key: value for key, value in baseline.items() if key not in left_out}}
    held_out = int(len(names) > FEWEST_TO_HOLD_OUT and rng.random() < HOLDOUT_CHANCE)
    fitted = len(names) - held_out
    content = {"plant": plant, "port": "a", "recordings": names[:fitted]}
    return {**content, "holdout": names[fitted:]} if held_out else content
