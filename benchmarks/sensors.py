"""Sensor cases with concealed effects, made by mechanisms and diagnosed: what is found, in a table.

python -m benchmarks.sensors [--seeds 2] [--first-seed 100] [--kind light_sensor]     # for development
python -m benchmarks.sensors --set 500 [--kind touch_sensor]                          # to be scored, once
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, count
from pathlib import Path
from typing import NamedTuple

import numpy as np

from nxt_twin.blind.score import Share
from nxt_twin.blind.sensors.cases import (
    SENSOR_EFFECTS,
    SENSOR_SIZES,
    SENSOR_SURPRISES,
    SensorCase,
    SensorPlantKind,
    SensorSize,
    make_sensor_case,
)
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.sensor.engine import diagnose_sensor
from nxt_twin.recording.case import Case

OUTCOMES = ("exact", "missed", "extra", "wrong")
REPEATS: dict[SensorPlantKind, int] = {"ultrasonic_sensor": 2, "light_sensor": 3, "touch_sensor": 10}
CLEAN = 15
UNKNOWN = 5
"""In a set that is scored: of each effect in each size, clean cases of each sensor, of each unknown effect."""
SEEDS_OF_A_SET = 1000
GROUPS = ("single small", "single medium", "single large", "clean", "pairs", "unknown")


class Wanted(NamedTuple):
    """A case to be made."""

    group: str
    kind: SensorPlantKind
    effects: tuple[str, ...]
    size: SensorSize
    seed: int


class Told(NamedTuple):
    """The answer of a diagnosis.

    Attributes:
        outcome: one of `OUTCOMES`.
        holds: whether what was named, with what it is confusable with, holds the truth.
        refused: whether it was called unexplained.
    """

    outcome: str
    holds: bool
    refused: bool


def main() -> None:
    """Make, diagnose and count."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=100)
    parser.add_argument("--set", type=int, help="make and score a whole set from this number")
    parser.add_argument("--kind", choices=list(SENSOR_EFFECTS))
    chosen = parser.parse_args()
    kinds: list[SensorPlantKind] = [chosen.kind] if chosen.kind else list(SENSOR_EFFECTS)
    tolds: dict[str, list[Told]] = {}
    for case in _scored(chosen.set) if chosen.set else _tried(chosen.first_seed, chosen.seeds):
        if case.kind in kinds:
            told = tell(case)
            for group in groups_of(case):
                tolds.setdefault(group, []).append(told)
    print()
    print(*table(tolds), sep="\n")


def _tried(first_seed: int, seeds: int) -> Iterator[Wanted]:
    """Everything once, with each of so many seeds."""
    for kind in SENSOR_EFFECTS:
        for group, effects, size in plan(kind):
            for seed in range(first_seed, first_seed + seeds):
                yield Wanted(group, kind, effects, size, seed)


def _scored(number: int) -> Iterator[Wanted]:
    """A set: each case has a seed of its own."""
    seeds = count(SEEDS_OF_A_SET * number)
    for kind in SENSOR_EFFECTS:
        for group, effects, size in plan(kind):
            repeats = CLEAN if group == "clean" else UNKNOWN if group == "unknown" else REPEATS[kind]
            repeats = 1 if group == "pairs" else repeats
            for _ in range(repeats):
                yield Wanted(group, kind, effects, size, next(seeds))


def groups_of(case: Wanted) -> Iterator[str]:
    """The lines of the table that a case counts in."""
    yield case.group
    yield f"{case.kind}, {case.group.split()[0]}"
    if len(case.effects) == 1:
        yield case.effects[0]


def tell(case: Wanted) -> Told:
    """Make the case, diagnose it, and print a line of it."""
    made = make_sensor_case(case.kind, case.effects, case.seed, case.size)
    said = diagnosed(made)
    outcome = judged(made, said)
    named = ", ".join(effect.id for effect in said.effects)
    marks = f"{'+'.join(case.effects) or f'clean {case.kind}':58s} {case.size:6s} {case.seed}"
    print(f"{outcome:7s} {marks} {said.verdict}: {named} {errors(made, said)}", flush=True)
    confusable = {other.id for effect in said.effects for other in effect.confusable_with}
    holds = set(made.effects) <= {effect.id for effect in said.effects} | confusable
    return Told(outcome, holds, said.verdict == "unexplained")


def table(tolds: Mapping[str, Sequence[Told]]) -> Iterator[str]:
    """What became of each group, in cases and with Wilson's 95 % interval."""
    yield f"{'cases':32s} {'exact':20s} {'holds truth':20s} {'unexplained':20s}"
    for group in sorted(tolds, key=lambda group: (group not in GROUPS, ", " not in group)):
        of = tolds[group]
        shares = [
            Share(sum(marks), len(of))
            for marks in (
                [told.outcome == "exact" for told in of],
                [told.holds for told in of],
                [told.refused for told in of],
            )
        ]
        counted = Counter(told.outcome for told in of)
        rest = ", ".join(f"{name} {counted[name]}" for name in OUTCOMES[1:] if counted[name])
        yield f"{group:32s} {shares[0]!s:20s} {shares[1]!s:20s} {shares[2]!s:20s} {rest}"


def plan(kind: SensorPlantKind) -> Iterator[tuple[str, tuple[str, ...], SensorSize]]:
    """Each effect in each size, clean cases, pairs, and what no library holds."""
    effects = tuple(SENSOR_EFFECTS[kind])
    yield from ((f"single {size}", (effect,), size) for size in SENSOR_SIZES for effect in effects)
    yield from (("clean", (), "medium") for _ in range(1))
    yield from (("pairs", pair, "medium") for pair in combinations(effects, 2))
    yield from (("unknown", (name,), "medium") for name in SENSOR_SURPRISES[kind])


def diagnosed(made: SensorCase) -> Diagnosis:
    """The diagnosis of a case that was made."""
    case = Case("case", Path(), dict(made.content["plant"]), made.recordings, (), None)
    return diagnose_sensor(case).diagnosis


def judged(made: SensorCase, said: Diagnosis) -> str:
    """Exact, missed (some of it, nothing false), extra (all of it and more), or wrong."""
    true = {effect for effect in made.effects if not effect.startswith("unknown")}
    found = {effect.id for effect in said.effects}
    if any(effect.startswith("unknown") for effect in made.effects):
        return "exact" if said.verdict == "unexplained" else "wrong"
    verdict = "explained" if true else "adequate"
    if found == true and said.verdict == verdict:
        return "exact"
    if found == true or not found:
        return "missed" if true else "wrong"
    return "missed" if found < true else "extra" if found > true else "wrong"


def errors(made: SensorCase, said: Diagnosis) -> str:
    """How far each parameter is off, in standard deviations and in percent."""
    told = []
    for effect in said.effects:
        for name, true in made.effects.get(effect.id, {}).items():
            if name in effect.params:
                got = effect.params[name]
                off = (got.value - true) / max(got.std, 1e-12)
                told.append(f"{name} {true:.4g}→{got.value:.4g} ({np.clip(off, -99, 99):+.1f} σ)")
    return "; ".join(told)


if __name__ == "__main__":
    main()
