"""Whether what an experiment identifies covers the truth: 95 % intervals over seeded repetitions on the mock.

python -m benchmarks identify
python -m benchmarks.identify [--study WORDS] [--first-seed N] [--repetitions N] [--workers N] [--cluster ADDRESS]

`benchmarks.identify_studies` says what a repetition is.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from benchmarks.identify_studies import STUDIES
from nxt_twin.fleet.workers.each import each
from nxt_twin.fleet.workers.place import Place, place_of

FIRST_SEED: Final = 43_000
REPETITIONS: Final = 200
REPETITIONS_OF_OTHERS: Final = 25
LEAST_PCT: Final = 90.0
MOST_PCT: Final = 98.0


class Repeated(NamedTuple):
    """The result of a repetition.

    Attributes:
        outcomes: by parameter.
        warned: whether it said that physics is missing.
        cost_s: processor time.
    """

    outcomes: dict[str, Outcome]
    warned: bool
    cost_s: float


class Outcome(NamedTuple):
    """One parameter in one repetition.

    Attributes:
        covered: whether the 95 % interval holds the truth.
        off: by how much the value is off, in its standard deviations.
        half_width: of the interval, in the parameter's unit.
    """

    covered: bool
    off: float
    half_width: float


def report() -> Iterator[str]:
    """Lines of the table."""
    return _tables(list(STUDIES), FIRST_SEED, None, place_of(os.cpu_count() or 1, None))


def main() -> None:
    """The table, or a part of it from other seeds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--study", default="", help="only studies whose name holds this")
    parser.add_argument("--first-seed", type=int, default=FIRST_SEED)
    parser.add_argument("--repetitions", type=int)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--cluster", help="address of a Dask scheduler; its workers can import this package")
    chosen = parser.parse_args()
    names = [name for name in STUDIES if chosen.study in name]
    if not names:
        parser.error(f"no study's name holds '{chosen.study}'; there are: {'; '.join(STUDIES)}")
    for line in _tables(
        names, chosen.first_seed, chosen.repetitions, place_of(chosen.workers, chosen.cluster)
    ):
        print(line, flush=True)


def _tables(names: Sequence[str], first_seed: int, repetitions: int | None, place: Place) -> Iterator[str]:
    yield f"seeds from {first_seed}; wanted: {LEAST_PCT:g} to {MOST_PCT:g} % covered"
    for name in names:
        usual = REPETITIONS_OF_OTHERS if name.startswith("NOT") else REPETITIONS
        yield from table(name, range(first_seed, first_seed + (repetitions or usual)), place)


def table(name: str, seeds: range, place: Place) -> Iterator[str]:
    """One study's lines: parameter, coverage, and the median interval's half width."""
    results = []
    for outcome in each(_repeat, [(name, seed) for seed in seeds], place):
        if outcome.result is None:
            raise SystemExit(f"{outcome.task}: {outcome.failure}")
        results.append(outcome.result)
    cost_s = sum(result.cost_s for result in results)
    warned = sum(result.warned for result in results)
    yield (
        f"{name}: {len(results)} repetitions, {warned} with the warning that physics is missing;"
        f" {cost_s:.0f} s of processor time"
    )
    for parameter in results[0].outcomes:
        found = [result.outcomes[parameter] for result in results]
        pct = 100.0 * float(np.mean([each.covered for each in found]))
        off = np.array([each.off for each in found])
        width = float(np.median([each.half_width for each in found]))
        mark = " " if LEAST_PCT <= pct <= MOST_PCT else "*"
        yield (
            f" {mark}{parameter:34s} {pct:5.1f} % covered   ± {width:.2g} typical"
            f"   mean {off.mean():+.2f} std {off.std():.2f} of the errors in standard deviations"
        )


def _repeat(task: tuple[str, int]) -> Repeated:
    name, seed = task
    begin_s = time.process_time()
    identified, truth = STUDIES[name](seed)
    found = {}
    for parameter, true in truth.items():
        value = identified.value(parameter)
        off = (value.value - true) / value.std
        found[parameter] = Outcome(value.covers(true), off, 0.5 * (value.high - value.low))
    warned = any("physics is missing" in note for note in identified.notes)
    return Repeated(found, warned, time.process_time() - begin_s)


if __name__ == "__main__":
    main()
