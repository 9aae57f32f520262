"""Make a pair: a motor recorded before and after it was touched, and a sealed answer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.blind.case import SEAL_FILE, ConcealedCase
from nxt_twin.blind.kinds import Size
from nxt_twin.blind.make import SALT_BYTES, write_case
from nxt_twin.blind.pairs.bench import Bench, BenchTruth, bench_of
from nxt_twin.blind.pairs.touches import TOUCHES, MotorTouch, stand_together
from nxt_twin.blind.sets import LARGEST_SEED
from nxt_twin.blind.spread import CaseTask, NameAndFailure, spread
from nxt_twin.errors import NxtTwinError
from nxt_twin.fleet.workers.place import HERE, Place
from nxt_twin.recording.recording import Recording

ANSWER_SCHEMA: Final = "nxt-twin/changes-answer/1"
SIZES: Final[tuple[Size, ...]] = ("medium", "large")
GIVEN_SPREAD: Final = 0.1
"""By how much a plant file is off in the numbers of an effect that acts before."""


@final
@dataclass(frozen=True)
class PairPlan:
    """One pair to be made."""

    name: str
    family: str
    seed: int
    touches: tuple[str, ...]


def plan_pairs(seed: int, families: Sequence[str], *, none: int, one: int, two: int) -> tuple[PairPlan, ...]:
    """So many pairs with no, one and two changes: families and changes in turn, in an order that tells nothing."""
    rng = np.random.default_rng(seed)
    every = list(TOUCHES)
    singles = [str(name) for name in rng.permutation(every)]
    contents: list[tuple[str, ...]] = [()] * none
    contents += [(singles[k % len(singles)],) for k in range(one)]
    contents += [_two(rng, every) for _ in range(two)]
    drawn = [(families[k % len(families)], touches) for k, touches in enumerate(contents)]
    return tuple(
        PairPlan(f"pair-{number:04d}", drawn[k][0], int(rng.integers(LARGEST_SEED)), drawn[k][1])
        for number, k in enumerate(rng.permutation(len(drawn)), start=1)
    )


def _two(rng: Generator, every: Sequence[str]) -> tuple[str, ...]:
    while True:
        one, other = (str(name) for name in rng.choice(list(every), 2, replace=False))
        if stand_together(TOUCHES[one], TOUCHES[other]):
            return one, other


@final
@dataclass(frozen=True)
class _Sides:
    """What is true on both sides, and what is known of it."""

    before: BenchTruth
    after: BenchTruth
    given: dict[str, dict[str, float]]
    changes: tuple[dict[str, Any], ...] = ()


def make_pair(plan: PairPlan) -> ConcealedCase:
    """Make one pair; equal plans make equal pairs."""
    rng = np.random.default_rng(plan.seed)
    bench = bench_of(rng, plan.family)
    sides = _Sides(bench.truth, bench.truth, {})
    touches = sorted((TOUCHES[name] for name in plan.touches), key=lambda touch: not touch.before)
    for touch in touches:
        sides = _touched(rng, bench, sides, touch)
    unread = any(touch.battery_unread for touch in touches)
    before = _recorded(rng, bench, sides.before, "before", unread)
    after = _recorded(rng, bench, sides.after, "after", unread)
    plant: dict[str, Any] = {"kind": "dc_motor", **bench.plant}
    content = {
        "plant": {**plant, "effects": sides.given} if sides.given else plant,
        "port": "a",
        "recordings": [one.name for one in after],
        "before": [one.name for one in before],
    }
    answer = {
        "schema": ANSWER_SCHEMA,
        "case": plan.name,
        "family": plan.family,
        "changes": list(sides.changes),
        "salt": rng.bytes(SALT_BYTES).hex(),
    }
    return ConcealedCase(plan.name, content, (*before, *after), answer, bench.sidecar)


def _touched(rng: Generator, bench: Bench, sides: _Sides, touch: MotorTouch) -> _Sides:
    before, after, given = sides.before, sides.after, sides.given
    params: Mapping[str, float] = {}
    if touch.effect:
        size = SIZES[int(rng.integers(len(SIZES)))]
        state = rng.bit_generator.state
        after, params = bench.with_effect(rng, after, touch.effect, size)
        if touch.before:
            rng.bit_generator.state = state
            before, _ = bench.with_effect(rng, before, touch.effect, size)
            off = 1.0 + GIVEN_SPREAD * rng.uniform(-1.0, 1.0)
            given = {**given, touch.effect: {key: _given(key, value, off) for key, value in params.items()}}
    low, high = touch.factors
    factor = float(low * (high / low) ** rng.random())
    if touch.either and rng.random() < 0.5:
        factor = 1.0 / factor
    change = {"id": touch.id, "factor": factor if touch.scales else None, "params": dict(params)}
    return _Sides(before, after.scaled(touch.scales, factor), given, (*sides.changes, change))


def _given(key: str, value: float, off: float) -> float:
    """What the plant file says of an effect's number: angles as they are, the rest a little off."""
    return float(f"{value if key.endswith('_deg') else value * off:.4g}")


def _recorded(
    rng: Generator, bench: Bench, truth: BenchTruth, name: str, unread: bool
) -> tuple[Recording, ...]:
    found = bench.record(rng, truth, name)
    if not unread:
        return found
    return tuple(
        replace(one, columns={key: values for key, values in one.columns.items() if key != "battery_v"})
        for one in found
    )


def make_pairs(
    plans: Sequence[PairPlan], cases: Path, answers: Path, *, place: Place = HERE
) -> Iterator[NameAndFailure]:
    """Make and write each pair that is not there yet, and yield its name and why it failed, if it did."""
    waiting = [plan for plan in plans if not (cases / plan.name / SEAL_FILE).exists()]
    yield from spread((CaseTask(plan.name, _make, (plan, cases, answers)) for plan in waiting), place)


def _make(plan: PairPlan, cases: Path, answers: Path) -> NameAndFailure:
    try:
        write_case(make_pair(plan), cases, answers)
    except NxtTwinError as error:
        return plan.name, str(error)
    return plan.name, ""
