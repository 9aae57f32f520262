"""Run plants over recordings: free or corrected at each reading, one parameter set or many, on all cores."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Self, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.abreast import FEWEST, LANES
from nxt_twin.physics.assemble import TRACE
from nxt_twin.physics.kernel import kernel
from nxt_twin.physics.layout import BASE_OWNER, Layout, Slot
from nxt_twin.physics.observer import Observer, free
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.start import Start
from nxt_twin.threads import threads_for

STEP_S = 1e-3
_BLOCKS = 1
"""Of lanes at once. Told at each call: a compiler that knows it would unroll the loops over lanes."""


@final
@dataclass(frozen=True)
class Job:
    """One recording to run a plant over."""

    signals: Signals
    observer: Observer
    start: Start
    disturbance_time_s: float = 1.0
    step_s: float = STEP_S


@final
@dataclass(frozen=True)
class Result:
    """The output of a run for each parameter set and sample, shape (sets, samples).

    Attributes:
        predicted: the reading expected before the sample's own correction.
        weight: the probability that the reading is no outlier, times the share of its variance that is ordinary
            noise. It is 1 without a model of outliers or scatter, and 0 where none was read.
        cost: negative log-likelihood of the reading.
    """

    predicted: FloatArray
    weight: FloatArray
    cost: FloatArray


@final
class Simulator:
    """Runs plants of one layout on all cores. A context manager: it owns its threads.

    Runs go on in these threads alone, so that an interrupt reaches whoever waits; leaving ends them at their next row.
    In `threads.one_of_many` there are none, and runs go on in the caller's.
    """

    def __init__(self, plan: Layout, workers: int | None = None) -> None:
        self._kernel = kernel(plan)
        self._pool, self._workers = threads_for(workers)
        self._stop = np.zeros(1, dtype=np.uint8)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop[0] = 1
        self._pool.shutdown(cancel_futures=True)

    def run(self, values: FloatArray, active: BoolArray, jobs: Sequence[Job]) -> list[Result]:
        """Run every parameter set over every job.

        Args:
            values: SI values in the layout's order, shape (sets, parameters).
            active: which effects act, shape (sets, effects).
            jobs: the recordings.
        """
        results = [_empty_result(values.shape[0], job) for job in jobs]
        pending = [
            self._pool.submit(self._run_chunk, values, active, job, result, low, high)
            for job, result in zip(jobs, results, strict=True)
            for low, high in itertools.pairwise(self._edges(values.shape[0]))
        ]
        for task in pending:
            task.result()
        return results

    def _edges(self, sets: int) -> list[int]:
        """Where chunks of `sets` begin and end: between sets that are run abreast."""
        blocks = math.ceil(sets / LANES)
        edges = np.linspace(0, blocks, min(self._workers, blocks) + 1).round().astype(int)
        return [min(LANES * int(edge), sets) for edge in edges]

    def trace(self, plant: Plant, job: Job) -> dict[str, FloatArray]:
        """One run of one plant, with what went on inside.

        Returns arrays of shape (samples,) by the names in `TRACE`, and `predicted`, `weight`, `cost`.
        """
        values, active = plant.vectors()
        result = _empty_result(1, job)
        trace = np.empty((job.signals.time_s.size, len(TRACE)))
        self._pool.submit(self._call, values[None], active[None], job, result, trace).result()
        inside = dict(zip(TRACE, trace.T, strict=True))
        return {
            **inside,
            "predicted": result.predicted[0],
            "weight": result.weight[0],
            "cost": result.cost[0],
        }

    def reached(self, plant: Plant, job: Job, at: BoolArray) -> Start:
        """Where one run of one plant has it at the samples `at`, the first included, all its states among it."""
        values, active = plant.vectors()
        states = 1 + sum(len(effect.states) for effect in plant.layout.effects)
        trace = np.empty((job.signals.time_s.size, len(TRACE) + states))
        result = _empty_result(1, job)
        self._pool.submit(self._call, values[None], active[None], job, result, trace).result()
        angle, speed = trace[:, TRACE.index("angle")], trace[:, TRACE.index("speed")]
        given = job.start.at
        return Start(
            at,
            np.where(given, job.start.position, angle),
            np.where(given, job.start.speed, speed),
            trace[at, len(TRACE) :],
        )

    def _run_chunk(
        self, values: FloatArray, active: BoolArray, job: Job, result: Result, low: int, high: int
    ) -> None:
        part = Result(result.predicted[low:high], result.weight[low:high], result.cost[low:high])
        self._call(values[low:high], active[low:high], job, part, np.empty((0, len(TRACE))))

    def _call(
        self, values: FloatArray, active: BoolArray, job: Job, result: Result, trace: FloatArray
    ) -> None:
        signals, start = job.signals, job.start
        together = partial(self._kernel.run_together, _BLOCKS)  # compiled when it is first needed
        run = together if values.shape[0] >= FEWEST else self._kernel.run_many
        run(
            values,
            active,
            job.step_s,
            signals.command_time_s,
            signals.command,
            signals.command_mode,
            signals.command_supply_v,
            signals.others_time_s,
            signals.others_load,
            signals.time_s,
            signals.measured,
            job.observer.gains,
            job.observer.innovation_std,
            start.at,
            start.position,
            start.speed,
            start.states,
            1.0 / job.disturbance_time_s,
            signals.is_speed,
            signals.session_s,
            result.predicted,
            result.weight,
            result.cost,
            trace,
            self._stop,
        )


def _empty_result(sets: int, job: Job) -> Result:
    rows = job.signals.time_s.size
    return Result(np.empty((sets, rows)), np.empty((sets, rows)), np.empty((sets, rows)))


def with_supply(signals: Signals, plant: Plant) -> Signals:
    """The signals with the plant's own supply wherever the battery was never read."""
    supply = plant.values.get(Slot(BASE_OWNER, "supply_v"), 0.0)
    filled = np.where(np.isfinite(signals.command_supply_v), signals.command_supply_v, supply)
    return replace(signals, command_supply_v=filled)


def free_job(signals: Signals, start: Start) -> Job:
    """A run that nothing corrects between starts."""
    return Job(signals, free(signals, 0.0), start)
