"""How far off a structure is where nothing corrects it, over the readings that check a choice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Result, Simulator, free_job
from nxt_twin.physics.start import Start, restarts


@final
class FreeRunCheck:
    """Free runs over the checking readings, started from what each plant's own observer knows.

    What does not depend on the plant is worked out once.
    """

    def __init__(self, jobs: Sequence[Job], check: Sequence[BoolArray], window_s: float) -> None:
        self._jobs = tuple(jobs)
        self._check = tuple(check)
        self._anew = tuple(restarts(job.signals, window_s).at for job in jobs)

    def rms(
        self, simulator: Simulator, plant: Plant, noise: Noise, corrected: Sequence[Result], step_s: float
    ) -> tuple[tuple[float, float], int]:
        """RMS error in the readings' SI unit: of runs that start anew every window, and of whole runs.

        Readings that a fault explains, as the `corrected` run tells, are left out; how many were not comes with it.
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
        errors = [
            _errors(run, result, check & (seen.weight[0] > 0.5))
            for run, result, check, seen in zip(
                runs, results, self._check * 2, [*corrected, *corrected], strict=True
            )
        ]
        windowed, unbroken = np.concatenate(errors[: len(known)]), np.concatenate(errors[len(known) :])
        return (_rms(windowed), _rms(unbroken)), unbroken.size

    def _start(
        self, simulator: Simulator, plant: Plant, noise: Noise, job: Job, anew: BoolArray, step_s: float
    ) -> Start:
        """Where `plant`'s own observer has it at each beginning of a window."""
        tuned = Job(job.signals, observer(job.signals, noise), job.start, noise.disturbance_time_s, step_s)
        return simulator.reached(plant, tuned, anew)


def _errors(run: Job, result: Result, judged: BoolArray) -> FloatArray:
    """Of the readings that are `judged`, but for those that the run was started from."""
    measured = run.signals.measured
    shown = judged & np.isfinite(measured) & ~run.start.at
    return np.asarray(measured[shown] - result.predicted[0, shown])


def _rms(errors: FloatArray) -> float:
    blown_up = errors.size == 0 or not np.isfinite(errors).all()
    return math.inf if blown_up else float(np.sqrt(np.mean(errors**2)))
