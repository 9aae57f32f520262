"""Concealed robots before and after something was done to them, by seed: made, compared and counted."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.robot.truth.body import TrueRobot
from nxt_twin.blind.robot.world import (
    NEEDS_POWER,
    ROBOT_EFFECTS,
    ROBOT_SURPRISES,
    Concealed,
    built_robot,
    drawn_robot,
    nominal_robot,
    recorded_run,
)
from nxt_twin.blind.share import Share
from nxt_twin.diagnose.dispatch import changed_any
from nxt_twin.recording.case import Case

_RUNS: Final = 3
_FRICTION: Final = ("left_motor.coulomb_friction_nm", "right_motor.coulomb_friction_nm")
_WHEELS: Final = ("left_wheel_radius_m", "right_wheel_radius_m")


def _wheel(side: str) -> Callable[[Generator], Concealed]:
    def worn(rng: Generator) -> Concealed:
        radius = TrueRobot().left_radius_m * (1.0 + float(rng.choice([-1.0, 1.0]) * rng.uniform(0.006, 0.03)))
        return Concealed({f"{side}_radius_m": radius}, truth={f"{side}_wheel_radius_m": radius})

    return worn


TOUCHES: Final[Mapping[str, Callable[[Generator], Concealed]]] = MappingProxyType(
    {
        "left_wheel_radius_m": _wheel("left"),
        "right_wheel_radius_m": _wheel("right"),
        "track_m": ROBOT_EFFECTS["wrong_track"],
        **{one: ROBOT_EFFECTS[one] for one in ("pose_offset", "wheel_slip", *NEEDS_POWER)},
        **dict.fromkeys(_FRICTION, lambda _: Concealed()),
    }
)
"""What may be done between two sides, by the name that a comparison gives it."""


@final
@dataclass(frozen=True)
class RobotPair:
    """Both sides of a robot, and what was done in between: names out of `TOUCHES`, or one of `ROBOT_SURPRISES`."""

    before: Case
    after: Case
    done: tuple[str, ...]


@final
@dataclass(frozen=True)
class PairOutcome:
    """The answer of a comparison to one pair."""

    seed: int
    done: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]

    @property
    def kind(self) -> str:
        """The things done, in a word."""
        if self.done and self.done[0] in ROBOT_SURPRISES:
            return "unknown"
        return ("nothing", "one change", "two changes")[len(self.done)]

    @property
    def exact(self) -> bool:
        """The right verdict with exactly the right names; an unknown change has to be refused."""
        if self.kind == "unknown":
            return self.verdict == "unexplained"
        return self.verdict == ("changed" if self.done else "unchanged") and set(self.named) == set(self.done)


def _chance(seed: int) -> Generator:
    return np.random.default_rng([seed, 19])


def make_pair(seed: int) -> RobotPair:
    """A robot whose model may be off, recorded three times before and three times after; equal seeds, equal pairs.

    Of ten seeds in a row, three change nothing, four one thing, two two things, and one something unknown.
    """
    rng = _chance(seed)
    done = _done(seed, rng)
    powered = bool({*NEEDS_POWER, *_FRICTION, "unknown_patch", "unknown_tether"} & set(done)) or bool(
        rng.random() < 0.5
    )
    robot = drawn_robot(rng)
    made = {one: ROBOT_SURPRISES[one] if one in ROBOT_SURPRISES else TOUCHES[one](rng) for one in done}
    after = built_robot(_sticky(robot, done, rng), made)
    seen = {name: value for one in made.values() for name, value in one.seen.items()}
    ratio = max((one.slip_ratio for one in made.values()), default=0.0)
    plant = nominal_robot(powered=powered)
    if rng.random() < 0.5:  # the model is off on both sides
        plant |= dict.fromkeys(_WHEELS, float(rng.uniform(0.97, 1.03)) * robot.left_radius_m)
        plant |= {"track_m": float(rng.uniform(0.95, 1.05)) * robot.track_m}
    return RobotPair(
        _side(f"before-{seed}", plant, robot, ({}, 0.0), rng),
        _side(f"after-{seed}", plant, after, (seen, ratio), rng),
        done,
    )


def _done(seed: int, rng: Generator) -> tuple[str, ...]:
    names = sorted(TOUCHES)
    match seed % 10:
        case 0 | 1 | 2:
            return ()
        case 9:
            return (str(rng.choice(sorted(ROBOT_SURPRISES))),)
        case 7 | 8:
            one, other = rng.choice(len(names), 2, replace=False)
            return tuple(sorted((names[one], names[other])))
        case _:
            return (names[int(rng.integers(len(names)))],)


def _sticky(robot: TrueRobot, done: Sequence[str], rng: Generator) -> TrueRobot:
    """The robot with more dry friction in the motors that were touched."""
    factors = [float(rng.uniform(1.5, 2.2)) if name in done else 1.0 for name in _FRICTION]
    left, right = (dry * factor for dry, factor in zip(robot.dry_nm, factors, strict=True))
    return replace(robot, dry_nm=(left, right))


def _side(
    name: str,
    plant: dict[str, Any],
    robot: TrueRobot,
    seen: tuple[Mapping[str, float], float],
    rng: Generator,
) -> Case:
    powered = "motor" in plant
    runs = tuple(
        recorded_run(f"{name}_{n}.csv", robot, *seen, rng, powered=powered) for n in range(1, _RUNS + 1)
    )
    return Case(name, Path(), plant, runs, (), None)


def solve_pairs(seeds: Iterable[int]) -> Iterator[PairOutcome]:
    """Make and compare each pair, in turn."""
    for seed in seeds:
        pair = make_pair(seed)
        said = changed_any(pair.before, [pair.after])[0]
        yield PairOutcome(seed, pair.done, said.verdict, tuple(change.of for change in said.changes))


def pairs_as_text(outcomes: Sequence[PairOutcome]) -> Iterator[str]:
    """The count of each kind, and every pair that is not exact."""
    for kind in ("nothing", "one change", "two changes", "unknown"):
        some = [one for one in outcomes if one.kind == kind]
        if some:
            yield f"{kind:24} {Share(sum(one.exact for one in some), len(some))}"
    for one in outcomes:
        if not one.exact:
            done, named = (", ".join(ids) or "nothing" for ids in (one.done, one.named))
            yield f"seed {one.seed}, {done}: {one.verdict}, {named}"
