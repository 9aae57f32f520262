"""Structures - sets of effects - fitted and weighed against each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.diagnose.fit import Fitted, Target, fit
from nxt_twin.diagnose.noise import estimate, with_noise
from nxt_twin.diagnose.observed import observed_starts
from nxt_twin.diagnose.problem import Problem
from nxt_twin.diagnose.variables import starts_of, variables_of
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Result, Simulator, free_job

_SHARE_ROUNDS = 3
_STARTS_FOLLOWED = 3
_START_ITERATIONS = 3
_SETTLE_ROUNDS = 4
_RESTING_NATS = 1.0
_CHECK_NOISES = (1.0, 2.0, 4.0, 8.0, 16.0)


@final
@dataclass(frozen=True)
class Structure:
    """A plant with its parameters and noise fitted.

    Attributes:
        fitted: the fit on the target's readings.
        noise: under which it was fitted.
        check_cost: negative log-likelihood of the readings that only check, nats.
        free_run_rms: error over the readings that only check, in their SI unit, of free runs that start anew
            every few seconds, and of one free run over each whole recording.
    """

    fitted: Fitted
    noise: Noise
    check_cost: float
    free_run_rms: tuple[float, float]

    @property
    def plant(self) -> Plant:
        """The fitted plant."""
        return self.fitted.plant


@final
@dataclass(frozen=True)
class Weight:
    """What speaks for a structure over a simpler one, nats.

    Attributes:
        gain: in likelihood of the readings that were fitted, less the information criterion's penalty.
        check_gain: in likelihood of readings that were not.
        free_run_ratio: its error in free runs over that of the simpler one.
    """

    gain: float
    check_gain: float
    free_run_ratio: float

    @property
    def total(self) -> float:
        """The sum of both, by which candidates are ranked."""
        return self.gain + self.check_gain


def weigh(simpler: Structure, richer: Structure) -> Weight:
    """What speaks for `richer` over `simpler`. Half a logarithm of the readings for each further parameter (BIC)."""
    further = len(richer.fitted.variables) - len(simpler.fitted.variables)
    further += _shares(richer.plant) - _shares(simpler.plant)
    penalty = 0.5 * further * math.log(max(richer.fitted.readings, 2))
    gain = simpler.fitted.cost + simpler.fitted.prior_cost - richer.fitted.cost - richer.fitted.prior_cost
    return Weight(gain - penalty, simpler.check_cost - richer.check_cost, free_run_ratio(simpler, richer))


def free_run_ratio(simpler: Structure, richer: Structure) -> float:
    """The error of `richer` in free runs over that of `simpler`, in the kinder of the two ways to run.

    A start anew cannot know the state of a load behind play or a shaft; a whole run of an integrator drifts.
    """
    pairs = zip(simpler.free_run_rms, richer.free_run_rms, strict=True)
    return min(after / max(before, 1e-15) for before, after in pairs)


@final
class Workshop:
    """Fits structures for one problem."""

    def __init__(self, simulator: Simulator, problem: Problem) -> None:
        self.simulator = simulator
        self.problem = problem

    def fit(self, plant: Plant, noise: Noise, *, iterations: int = 12) -> Structure:
        """Fit `plant` on the target's readings under `noise`."""
        return self._fit_on(self.problem.target, plant, noise, iterations)

    def fit_everything(self, plant: Plant, noise: Noise) -> Structure:
        """Fit `plant` on every reading that is not held out, under the noise that suits it."""
        target = self.problem.everything()
        for _ in range(2):
            done = self._fit_on(target, plant, noise, 15)
            plant = done.plant
            noise, _ = estimate(self.simulator, plant, target, noise)
        return self._fit_on(target, plant, noise, 15)

    def fit_on_everything(self, plant: Plant, noise: Noise) -> Structure:
        """Fit `plant` on every reading that is not held out, under just this noise."""
        return self._fit_on(self.problem.everything(), plant, noise, 25)

    def settle(self, structure: Structure) -> Structure:
        """The structure under the noise that suits it best: noise and parameters in turn until both rest."""
        for _ in range(_SETTLE_ROUNDS):
            noise, _ = estimate(self.simulator, structure.plant, self.problem.target, structure.noise)
            before, structure = structure, self.fit(structure.plant, noise)
            if before.fitted.cost - structure.fitted.cost < _RESTING_NATS:
                break
        return structure

    def start_with(self, plant: Plant, effect: Effect, noise: Noise) -> Plant:
        """`plant` with `effect` added, a few steps on from the likelier of its starting values."""
        trials = [
            _with_load_split(plant.with_effect(effect.id, start), effect)
            for start in starts_of(effect, self.problem.scale)
        ]
        values = np.array([trial.vectors()[0] for trial in trials])
        active = np.array([trial.vectors()[1] for trial in trials])
        target = with_noise(self.problem.target, noise)
        costs = target.cost(self.simulator.run(values, active, target.jobs))
        likely = [trials[int(i)] for i in np.argsort(costs)[:_STARTS_FOLLOWED]]
        if len(effect.parameters) == 1 or len(likely) == 1:
            return likely[0]
        followed = [self.fit(trial, noise, iterations=_START_ITERATIONS) for trial in likely]
        totals = [structure.fitted.cost + structure.fitted.prior_cost for structure in followed]
        return followed[int(np.argmin(totals))].plant

    def _fit_on(self, target: Target, plant: Plant, noise: Noise, iterations: int) -> Structure:
        tuned = with_noise(target, noise)
        for _ in range(_SHARE_ROUNDS if _shares(plant) else 1):
            variables = variables_of(plant, self.problem.plant, self.problem.scale)
            fitted = fit(self.simulator, plant, variables, tuned, iterations=iterations)
            plant = self._with_shares(fitted.plant, tuned)
        fitted = replace(fitted, plant=plant)
        values, active = plant.vectors()
        results = self.simulator.run(values[None], active[None], tuned.jobs)
        windowed, whole = (
            self._free_run_rms(plant, noise, results, every_s)
            for every_s in (self.problem.window_s, math.inf)
        )
        return Structure(fitted, noise, self._check_cost(plant, target, noise), (windowed, whole))

    def _check_cost(self, plant: Plant, target: Target, noise: Noise) -> float:
        """The checking readings' cost under the kindest of a few noises.

        A structure that fits well is sure of itself; on other inputs that must not count against it.
        """
        values, active = plant.vectors()
        checking = replace(target, counted=self.problem.check)
        costs = []
        for factor in _CHECK_NOISES:
            tuned = with_noise(checking, replace(noise, disturbance_std=factor * noise.disturbance_std))
            costs.append(float(tuned.cost(self.simulator.run(values[None], active[None], tuned.jobs))[0]))
        return min(costs)

    def _free_run_rms(self, plant: Plant, noise: Noise, corrected: Sequence[Result], every_s: float) -> float:
        """RMS error of free runs over the checking readings; those that a fault explains are left out."""
        errors = []
        for job, seen, check in zip(self.problem.target.jobs, corrected, self.problem.check, strict=True):
            signals = job.signals
            start = observed_starts(self.simulator, plant, signals, job.start, noise, every_s)
            predicted = self.simulator.trace(plant, free_job(signals, start))["predicted"]
            judged = check & np.isfinite(signals.measured) & ~start.at & (seen.weight[0] > 0.5)
            errors.append((signals.measured - predicted)[judged])
        joined = np.concatenate(errors)
        blown_up = joined.size == 0 or not np.isfinite(joined).all()
        return math.inf if blown_up else float(np.sqrt(np.mean(joined**2)))

    def _with_shares(self, plant: Plant, target: Target) -> Plant:
        """Set the share of each fault to the mean probability with which it explains a reading."""
        if not _shares(plant):
            return plant
        values, active = plant.vectors()
        results = self.simulator.run(values[None], active[None], target.jobs)
        doubts = np.concatenate(
            [
                1.0 - result.weight[0, mask & np.isfinite(job.signals.measured) & ~job.start.at]
                for result, job, mask in zip(results, target.jobs, target.counted, strict=True)
            ]
        )
        new = {}
        for effect in plant.effects:
            if "outlier" in effect.terms:
                share = effect.parameters[0]
                new[Slot(effect.id, share.symbol)] = float(np.clip(doubts.mean(), share.lower, share.upper))
        return plant.with_values(new)


def _with_load_split(plant: Plant, effect: Effect) -> Plant:
    """Take a new load's inertia off the body, which has carried it until now."""
    load = Slot(effect.id, "load_inertia")
    if load not in plant.values:
        return plant
    body = Slot(BASE_OWNER, "inertia")
    total = plant.values[body]
    share = plant.values[load] / (plant.values[load] + plant.layout.parameters[body].starts[0])
    return plant.with_values({body: (1.0 - share) * total, load: share * total})


def _shares(plant: Plant) -> int:
    return sum("outlier" in effect.terms for effect in plant.effects)
