"""Run plants over recordings: free or corrected at each reading, one parameter set or many, on all cores."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from threading import Lock, local
from typing import Self, TypeVar, final

import numpy as np
from numpy.typing import NDArray

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

ItemT = TypeVar("ItemT")
ResultT = TypeVar("ResultT")


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
        self._states = 1 + sum(len(effect.states) for effect in plan.effects)
        self._pool, self._workers = threads_for(workers)
        self._thinkers, _ = threads_for(workers)
        self._within = local()
        self._grouping = Lock()
        self._stop = np.zeros(1, dtype=np.uint8)
        self._groups: dict[tuple[int, ...], tuple[tuple[Job, ...], list[_Group]]] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop[0] = 1
        self._pool.shutdown(cancel_futures=True)
        self._thinkers.shutdown(cancel_futures=True)

    def abreast(self, function: Callable[[ItemT], ResultT], items: Iterable[ItemT]) -> list[ResultT]:
        """What `function`, which runs simulations, gives for each of `items`, which do not depend on one another.

        While one of them evaluates its runs, another keeps the cores busy. Within one of them, items go one by one.
        """
        every = list(items)
        if len(every) < 2 or self._workers == 1 or getattr(self._within, "one", False):
            return [function(item) for item in every]
        tasks = [self._thinkers.submit(self._within_one, function, item) for item in every]
        try:
            return [task.result() for task in tasks]
        finally:
            for task in tasks:
                task.cancel()

    def _within_one(self, function: Callable[[ItemT], ResultT], item: ItemT) -> ResultT:
        self._within.one = True
        return function(item)

    def run(self, values: FloatArray, active: BoolArray, jobs: Sequence[Job]) -> list[Result]:
        """Run every parameter set over every job.

        Args:
            values: SI values in the layout's order, shape (sets, parameters).
            active: which effects act, shape (sets, effects).
            jobs: the recordings.
        """
        groups, size = self._grouped(jobs), len(values)
        found = self._run([group.sets(values, active) for group in groups])
        results = {
            n: _part(whole, number * size, (number + 1) * size)
            for group, whole in zip(groups, found, strict=True)
            for number, n in enumerate(group.rows)
        }
        return [results[n] for n in range(len(jobs))]

    def run_own(self, values: FloatArray, active: BoolArray, jobs: Sequence[Sequence[Job]]) -> list[Result]:
        """Run each parameter set over jobs of its own, which differ from those of other sets in gains and starts alone.

        Args:
            values: SI values in the layout's order, shape (sets, parameters).
            active: which effects act, shape (sets, effects).
            jobs: of each recording one job a set.
        """
        rows = np.arange(len(values), dtype=np.uint32)
        return self._run([_Sets(own[0], values, active, rows, _corrections(own)) for own in jobs])

    def _run(self, every: Sequence[_Sets]) -> list[Result]:
        """What all rows of each give, on all cores."""
        chunks = math.ceil(self._workers / max(len(every), 1))
        found = [_empty_result(len(sets.of_job), sets.job) for sets in every]
        pending = [
            self._pool.submit(self._call, sets.part(low, high), _part(whole, low, high), _NO_TRACE)
            for sets, whole in zip(every, found, strict=True)
            for low, high in itertools.pairwise(_edges(len(sets.of_job), chunks))
        ]
        for task in pending:
            task.result()
        return found

    def _grouped(self, jobs: Sequence[Job]) -> list[_Group]:
        """`jobs` that may be run abreast together; a fit runs its jobs many times, so the latest are kept."""
        key = tuple(map(id, jobs))
        with self._grouping:
            if key not in self._groups:
                while len(self._groups) >= _GROUPS_KEPT:
                    self._groups.pop(next(iter(self._groups)), None)
                self._groups[key] = (tuple(jobs), _abreast(jobs))
            return self._groups[key][1]

    def trace(self, plant: Plant, job: Job) -> dict[str, FloatArray]:
        """One run of one plant, with what went on inside.

        Returns arrays of shape (samples,) by the names in `TRACE`, and `predicted`, `weight`, `cost`.
        """
        values, active = plant.vectors()
        result = _empty_result(1, job)
        trace = np.empty((job.signals.time_s.size, len(TRACE)))
        self._pool.submit(
            self._call, _abreast([job])[0].sets(values[None], active[None]), result, trace
        ).result()
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
        return self.reached_by(values[None], active[None], [job], [at])[0][0]

    def reached_by(
        self, values: FloatArray, active: BoolArray, jobs: Sequence[Job], at: Sequence[BoolArray]
    ) -> list[list[Start]]:
        """Where the run of each parameter set over each job has it at the samples `at` of the job.

        Args:
            values: SI values in the layout's order, shape (sets, parameters).
            active: which effects act, shape (sets, effects).
            jobs: the recordings.
            at: samples of each, the first included, shape (samples,).

        Returns:
            By job, one start a set, with all states.
        """
        pending = [
            [
                self._pool.submit(self._reached, own.sets(values[n : n + 1], active[n : n + 1]), samples)
                for n in rows
            ]
            for own, samples, rows in (
                (_abreast([job])[0], samples, range(len(values)))
                for job, samples in zip(jobs, at, strict=True)
            )
        ]
        return [[task.result() for task in own] for own in pending]

    def _reached(self, sets: _Sets, at: BoolArray) -> Start:
        """Where the run of the only row of `sets` has it at the samples `at`."""
        job, names = sets.job, len(TRACE)
        trace = np.empty((job.signals.time_s.size, names + self._states))
        self._call(sets, _empty_result(1, job), trace)
        angle, speed = trace[:, TRACE.index("angle")], trace[:, TRACE.index("speed")]
        given = job.start.at
        return Start(
            at,
            np.where(given, job.start.position, angle),
            np.where(given, job.start.speed, speed),
            trace[at, names:],
        )

    def _call(self, sets: _Sets, result: Result, trace: FloatArray) -> None:
        job = sets.job
        signals = job.signals
        run = self._kernel.run_together if len(sets.of_job) >= FEWEST else self._kernel.run_many
        run(
            sets.values,
            sets.active,
            sets.of_job,
            job.step_s,
            signals.command_time_s,
            signals.command_moments,
            signals.command,
            signals.command_mode,
            signals.command_supply_v,
            signals.others_time_s,
            signals.others_load,
            signals.time_s,
            signals.ages,
            signals.measured,
            *sets.corrections,
            1.0 / job.disturbance_time_s,
            signals.is_speed,
            signals.session_s,
            signals.clock_s,
            result.predicted,
            result.weight,
            result.cost,
            trace,
            self._stop,
        )


_GROUPS_KEPT = 4
_NO_TRACE = np.empty((0, len(TRACE)))


@final
@dataclass(frozen=True)
class _Sets:
    """Parameter sets over jobs that differ only in gains and starts, one row each.

    Attributes:
        job: any of the jobs.
        values, active: of each row, shape (rows, parameters) and (rows, effects).
        of_job: which job each row runs, shape (rows,).
        corrections: gains, deviations of innovations, and starts of the jobs, shape (jobs, …).
    """

    job: Job
    values: FloatArray
    active: BoolArray
    of_job: NDArray[np.uint32]
    corrections: tuple[FloatArray | BoolArray, ...]

    def part(self, low: int, high: int) -> _Sets:
        """Some of the rows."""
        own = slice(low, high)
        return _Sets(self.job, self.values[own], self.active[own], self.of_job[own], self.corrections)


@final
@dataclass(frozen=True)
class _Group:
    """Jobs that differ only in gains and starts.

    Attributes:
        rows: which of the jobs that are run.
        job: any of them.
        corrections: as `_Sets` has them.
    """

    rows: tuple[int, ...]
    job: Job
    corrections: tuple[FloatArray | BoolArray, ...]

    def sets(self, values: FloatArray, active: BoolArray) -> _Sets:
        """Every set over every job, job by job."""
        size = len(self.rows)
        if size == 1:
            return _Sets(self.job, values, active, np.zeros(len(values), dtype=np.uint32), self.corrections)
        return _Sets(
            self.job,
            np.tile(values, (size, 1)),
            np.tile(active, (size, 1)),
            np.repeat(np.arange(size, dtype=np.uint32), len(values)),
            self.corrections,
        )


def _abreast(jobs: Sequence[Job]) -> list[_Group]:
    """`jobs` by what takes equal steps past equal readings, so that their sets may be run abreast."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for number, job in enumerate(jobs):
        judged = bool(job.observer.innovation_std[0] > 0.0)
        alike = (id(job.signals), job.step_s, job.disturbance_time_s, judged, job.start.states.shape)
        groups.setdefault(alike, []).append(number)
    return [
        _Group(tuple(rows), jobs[rows[0]], _corrections([jobs[n] for n in rows])) for rows in groups.values()
    ]


def _corrections(jobs: Sequence[Job]) -> tuple[FloatArray | BoolArray, ...]:
    parts = [
        (
            job.observer.gains,
            job.observer.innovation_std,
            job.start.at,
            job.start.position,
            job.start.speed,
            job.start.states,
        )
        for job in jobs
    ]
    if len(parts) == 1:
        return tuple(each[None] for each in parts[0])
    return tuple(np.array(each) for each in zip(*parts, strict=True))


def _edges(rows: int, chunks: int) -> list[int]:
    """Where `chunks` of `rows` begin and end: between blocks of rows that are run abreast."""
    blocks = math.ceil(rows / LANES)
    if min(chunks, blocks) <= 1:
        return [0, rows]
    edges = np.linspace(0, blocks, min(chunks, blocks) + 1).round().astype(int)
    return [min(LANES * int(edge), rows) for edge in edges]


def _part(whole: Result, low: int, high: int) -> Result:
    return Result(whole.predicted[low:high], whole.weight[low:high], whole.cost[low:high])


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
