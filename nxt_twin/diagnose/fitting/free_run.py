"""How far off a structure is where nothing corrects it, over the readings that check a choice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.fitting.doubted import is_doubted
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Result, Simulator, free_job
from nxt_twin.physics.start import Start, restarts

_TINY = 1e-12  # keeps a ratio of errors finite


@final
class FreeRunCheck:
    """Free runs over the checking readings, started from what each plant's own observer knows.

    What does not depend on the plant is worked out once.
    """

    def __init__(self, jobs: Sequence[Job], check: Sequence[BoolArray], window_s: float) -> None:
        self._jobs = tuple(jobs)
        self._check = tuple(check)
        self._anew = tuple(restarts(job.signals, window_s).at for job in jobs)
        self._windows = [np.asarray(np.cumsum(at), dtype=np.int64) for at in self._anew]

    def errors(
        self, simulator: Simulator, plant: Plant, noise: Noise, corrected: Sequence[Result], step_s: float
    ) -> tuple[tuple[FloatArray, FloatArray], int]:
        """RMS error of each window in the readings' SI unit: of runs that start anew there, and of whole runs.

        Readings that a fault explains, as the `corrected` run tells, are left out; how many were not comes with it. A
        window without any has NaN.
        """
        known = [
            self._start(simulator, plant, noise, job, anew, step_s)
            for job, anew in zip(self._jobs, self._anew, strict=True)
        ]
        whole = [job.start for job in self._jobs]
        runs = [
            replace(free_job(job.signals, start), step_s=step_s)
            for starts in (known, whole)
            for job, start in zip(self._jobs, starts, strict=True)
        ]
        values, active = plant.vectors()
        results = simulator.run(values[None], active[None], runs)
        faults = any("outlier" in effect.terms for effect in plant.effects)
        judged = [
            check & ~(is_doubted(plant, seen.weight[0]) & faults) & np.isfinite(job.signals.measured)
            for job, check, seen in zip(self._jobs, self._check, corrected, strict=True)
        ]
        errors = [
            _errors(run, result, mask, window)
            for run, result, mask, window in zip(
                runs, results, [*judged, *judged], [*self._windows, *self._windows], strict=True
            )
        ]
        size = len(known)
        believed = sum(
            int((mask & ~job.start.at).sum()) for job, mask in zip(self._jobs, judged, strict=True)
        )
        return (np.concatenate(errors[:size]), np.concatenate(errors[size:])), believed

    def _start(
        self, simulator: Simulator, plant: Plant, noise: Noise, job: Job, anew: BoolArray, step_s: float
    ) -> Start:
        """Where `plant`'s own observer has it at each beginning of a window."""
        tuned = Job(job.signals, observer(job.signals, noise), job.start, noise.disturbance_time_s, step_s)
        return simulator.reached(plant, tuned, anew)


def _errors(run: Job, result: Result, judged: BoolArray, window: IntArray) -> FloatArray:
    """RMS error of each window, over the readings that are `judged` but for those that the run was started from."""
    shown = judged & ~run.start.at
    size = int(window.max(initial=0)) + 1
    square = (run.signals.measured - result.predicted[0])[shown] ** 2
    count = np.bincount(window[shown], minlength=size)
    total = np.bincount(window[shown], np.nan_to_num(square, nan=math.inf), minlength=size)
    return np.asarray(np.where(count > 0, np.sqrt(total / np.maximum(count, 1)), math.nan))


def mean_error(errors: FloatArray) -> float:
    """The mean of windows' errors: one in which a motor on the edge of sticking goes another way does not outweigh all.

    Infinite where no window has a reading.
    """
    known = errors[~np.isnan(errors)]
    return float(np.mean(known)) if known.size else math.inf


def error_ratio(before: FloatArray, after: FloatArray, slight: float = 0.0) -> float:
    """By what factor windows' errors grow: the geometric mean over windows, so that each one counts alike.

    Errors below `slight` count as that. A motor at rest is off by next to nothing with any plant. Else a hundredth of a
    count more would outweigh the windows in which it moves.
    """
    known = ~(np.isnan(before) | np.isnan(after))
    if not known.any():
        return 1.0
    least = max(slight, _TINY)
    factors = np.maximum(after[known], least) / np.maximum(before[known], least)
    return float(np.exp(np.mean(np.log(factors))))
