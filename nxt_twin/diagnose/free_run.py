"""How far off a structure is where nothing corrects it, over the readings that check a choice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import final

import numpy as np

from nxt_twin.diagnose.fit import BoolArray
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Result, Simulator, free_job
from nxt_twin.physics.start import Start, restarts
from nxt_twin.recording.recording import FloatArray


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
        windowed: list[FloatArray] = []
        whole: list[FloatArray] = []
        for job, seen, check, anew in zip(self._jobs, corrected, self._check, self._anew, strict=True):
            gains = observer(job.signals, noise)
            tuned = Job(job.signals, gains, job.start, noise.disturbance_time_s, step_s)
            trace = simulator.trace(plant, tuned)
            first = job.start
            known = Start(
                anew,
                np.where(first.at, first.position, trace["angle"]),
                np.where(first.at, first.speed, trace["speed"]),
            )
            for start, errors in ((known, windowed), (first, whole)):
                free = replace(free_job(job.signals, start), step_s=step_s)
                predicted = simulator.trace(plant, free)["predicted"]
                judged = check & np.isfinite(job.signals.measured) & ~start.at & (seen.weight[0] > 0.5)
                errors.append((job.signals.measured - predicted)[judged])
        return (_rms(np.concatenate(windowed)), _rms(np.concatenate(whole))), sum(e.size for e in whole)


def _rms(errors: FloatArray) -> float:
    blown_up = errors.size == 0 or not np.isfinite(errors).all()
    return math.inf if blown_up else float(np.sqrt(np.mean(errors**2)))
