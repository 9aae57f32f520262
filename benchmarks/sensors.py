"""Sensor cases with concealed effects, made by mechanisms and diagnosed: what is found, in a table.

python -m benchmarks.sensors [--seeds 2] [--first-seed 100] [--kind light_sensor]
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np

from nxt_twin.blind.sensors.cases import (
    SENSOR_EFFECTS,
    SENSOR_SIZES,
    SENSOR_SURPRISES,
    SensorCase,
    SensorKind,
    SensorSize,
    make_sensor_case,
)
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.sensor.engine import diagnose_sensor
from nxt_twin.recording.case import Case


def main() -> None:
    """Make, diagnose and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=100)
    parser.add_argument("--kind", choices=list(SENSOR_EFFECTS))
    chosen = parser.parse_args()
    counts: Counter[tuple[str, str]] = Counter()
    kinds = [chosen.kind] if chosen.kind else list(SENSOR_EFFECTS)
    for kind in kinds:
        for group, effects, size in plan(kind):
            for seed in range(chosen.first_seed, chosen.first_seed + chosen.seeds):
                made = make_sensor_case(kind, effects, seed, size)
                said = diagnosed(made)
                outcome = judged(made, said)
                counts[group, outcome] += 1
                named = ", ".join(f"{effect.id}" for effect in said.effects)
                marks = f"{'+'.join(effects) or 'clean':58s} {size:6s} {seed}"
                print(f"{outcome:7s} {marks} {said.verdict}: {named} {errors(made, said)}")
                sys.stdout.flush()
    print()
    for group in dict.fromkeys(group for group, _ in counts):
        of = sum(count for (other, _), count in counts.items() if other == group)
        told = ", ".join(
            f"{outcome} {counts[group, outcome]}" for outcome in OUTCOMES if counts[group, outcome]
        )
        print(f"{group:12s} of {of}: {told}")


OUTCOMES = ("exact", "missed", "extra", "wrong")


def plan(kind: SensorKind) -> Iterator[tuple[str, tuple[str, ...], SensorSize]]:
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
