"""Gains of effects where none is missing: by noise alone, and on clean motors whose equations are a little off.

`python -m benchmarks.null 60 2` takes seeds 60 and 61 of each truth family. Noise alone: synthetic recordings of the
final model (a parametric bootstrap), and the largest gain of any effect that check readings bear out. Clean motors:
the effect that the search came nearest to adding, or added. `SearchLimits.gain_nats` is to lie above the first.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from benchmarks.consistency import home, problem_of
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.diagnose.fitting.linear import trials_of
from nxt_twin.diagnose.judging.calibrate import clean_cases, null_gains
from nxt_twin.diagnose.judging.detectable import allowed
from nxt_twin.diagnose.judging.evidence import gather
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.searched import searched
from nxt_twin.physics.simulate import Simulator

FIRST_SEED, SEEDS = 60, 2
RARELY = 0.99


@final
@dataclass(frozen=True)
class Null:
    """Gains on one clean motor, nats.

    Attributes:
        by_noise: largest gain in each synthetic case; -inf where check readings bear none out.
        nearest: gain of the nearest effect on the motor's own recordings; -inf where none came near.
        named: how many effects the search added.
    """

    by_noise: np.ndarray
    nearest: float
    named: int


def null_of(family: str, seed: int) -> Null:
    """The gains on a clean motor of a family."""
    problem = problem_of(home(seed, family=family))
    rng = np.random.default_rng(seed)
    with Simulator(problem.plant.layout) as simulator:
        found = searched(simulator, problem, lambda _: None)
        evidence = gather(simulator, problem, found, rng)
        effects = allowed(problem, evidence.final.plant)
        trials = [trial for effect in effects for trial in trials_of(effect, problem.scale)]
        clean = clean_cases(evidence.linear, rng)
        gains = null_gains(simulator, evidence.linear, trials, clean)
    explanation = evidence.explanation
    near = [one[1].gain for one in (*explanation.found, *explanation.refused)]
    return Null(gains, max(near, default=-np.inf), len(explanation.found))


def report(first: int = FIRST_SEED, count: int = SEEDS) -> Iterator[str]:
    """A line for each motor, and how the limit lies."""
    yield f"{'':18} noise alone: 99 %, largest of  above {LIMITS.gain_nats:g}   clean motor: nearest effect, named"
    largest = []
    for family in FAMILIES:
        for seed in range(first, first + count):
            one = null_of(family, seed)
            largest.append(float(one.by_noise.max()))
            rare = float(np.quantile(one.by_noise, RARELY, method="inverted_cdf"))
            above = int(np.sum(one.by_noise > LIMITS.gain_nats))
            cells = f"{rare:17.1f}, {largest[-1]:7.1f} of {one.by_noise.size:3} {above:8}"
            yield f"{family:9} seed {seed:3} {cells} {one.nearest:27.1f}, {one.named}"
    yield f"largest gain by noise alone: {max(largest):.1f}; asked for: {LIMITS.gain_nats:g} nats"


def main(arguments: Sequence[str]) -> None:
    """First seed, number of seeds."""
    for line in report(*map(int, arguments)):
        print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
