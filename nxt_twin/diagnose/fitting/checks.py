"""Likelihood and errors of a fitted plant on the check readings, which only judge a choice."""

from __future__ import annotations

from dataclasses import replace
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fit import Fitted
from nxt_twin.diagnose.fitting.free_run import FreeRunCheck, mean_error
from nxt_twin.diagnose.fitting.noise import with_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Result, Simulator

_CHECK_NOISES = (1.0, 2.0, 4.0, 8.0, 16.0)
_SHORT = 0.25  # of a window
_SLIGHT = 0.5  # of the tolerance: rounding leaves 0.58 of it to a motor that moves


@final
class Checks:
    """The checking readings of one problem."""

    def __init__(self, simulator: Simulator, problem: Problem) -> None:
        self._simulator = simulator
        self._checking = problem.objective.checking()
        self._predicting = problem.target
        everything = problem.target.everything()
        self._every_run = FreeRunCheck(everything.jobs, everything.counted, problem.window_s)
        self._short_runs = FreeRunCheck(everything.jobs, everything.counted, _SHORT * problem.window_s)
        self._free_runs = FreeRunCheck(problem.target.jobs, problem.check, problem.window_s)
        self._slight = _SLIGHT * problem.tolerance

    def simulated_error(self, plant: Plant, noise: Noise, step_s: float) -> float:
        """The mean error of windows of simulation over fitted and checking readings, SI."""
        corrected = self._corrected(plant, noise, step_s)
        return mean_error(self._every_run.errors(self._simulator, plant, noise, corrected, step_s)[0][0])

    def simulated_errors(self, plant: Plant, noise: Noise, step_s: float) -> FloatArray:
        """That error in short windows, in windows and over whole runs, SI, shape (3,)."""
        corrected = self._corrected(plant, noise, step_s)
        anew, whole = self._every_run.errors(self._simulator, plant, noise, corrected, step_s)[0]
        short = self._short_runs.errors(self._simulator, plant, noise, corrected, step_s)[0][0]
        return np.array([mean_error(each) for each in (short, anew, whole)])

    def _corrected(self, plant: Plant, noise: Noise, step_s: float) -> list[Result]:
        """The run that each reading corrects, which tells faults from readings."""
        values, active = plant.vectors()
        tuned = with_noise(self._predicting.with_step(step_s), noise)
        return self._simulator.run(values[None], active[None], tuned.jobs)

    def checked(self, fitted: Fitted, noise: Noise, step_s: float) -> Structure:
        """The fitted plant with its cost on the checking readings and its error in free runs over them.

        The cost is the least under a few noises. A structure that fits well has a small noise, and under that noise
        it would pay for other inputs.
        """
        plant = fitted.plant
        values, active = plant.vectors()
        checking = self._checking.with_step(step_s)
        kinder = [replace(noise, disturbance_std=f * noise.disturbance_std) for f in _CHECK_NOISES]
        tuned = [with_noise(checking, one) for one in kinder]
        results = self._simulator.run(values[None], active[None], [job for one in tuned for job in one.jobs])
        size = len(checking.jobs)
        costs = [float(one.cost(results[n * size : (n + 1) * size])[0]) for n, one in enumerate(tuned)]
        errors, believed = self._free_runs.errors(
            self._simulator, plant, noise, results[: len(self._predicting.jobs)], step_s
        )
        return Structure(fitted, noise, min(costs), errors, believed, self._slight)
