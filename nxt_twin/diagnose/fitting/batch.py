"""Many parameter sets over recordings of any length, a few sets at a time, so that an hour of them fits in memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.simulate import Job, Result, Simulator

_MOST_READINGS = 1_000_000  # in one batch; a run gives three numbers a reading


def batches(sets: int, readings: int) -> Iterator[slice]:
    """Parts of a number of `sets`, with a number of `readings` each, that stay small in memory."""
    size = max(1, _MOST_READINGS // max(readings, 1))
    for first in range(0, sets, size):
        yield slice(first, min(first + size, sets))


def samples_of(jobs: Sequence[Job]) -> int:
    """Of all jobs together."""
    return sum(job.signals.time_s.size for job in jobs)


def batch_predictions(
    simulator: Simulator,
    values: FloatArray,
    active: BoolArray,
    jobs: Sequence[Job],
    wanted: Sequence[BoolArray],
) -> tuple[list[FloatArray], list[Result]]:
    """What each set predicts, by job at the samples that are `wanted`, and all that the last set's run gives.

    Args:
        simulator: runs them.
        values: SI values in the layout's order, shape (sets, parameters).
        active: which effects act, shape (sets, effects).
        jobs: the recordings.
        wanted: which samples of each job, shape (samples,).

    Returns:
        Arrays of shape (sets, wanted samples) by job, and results of one set.
    """
    found = [np.empty((len(values), int(mask.sum()))) for mask in wanted]
    last: list[Result] = []
    for part in batches(len(values), samples_of(jobs)):
        results = simulator.run(values[part], active[part], jobs)
        for own, result, mask in zip(found, results, wanted, strict=True):
            own[part] = result.predicted[:, mask]
        last = [one_of(result, -1) for result in results]
    return found, last


def one_of(result: Result, row: int) -> Result:
    """One parameter set's part of a result, by itself."""
    own = np.array([row])
    return Result(result.predicted[own], result.weight[own], result.cost[own])
