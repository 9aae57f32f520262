"""Structures - sets of effects - fitted, and judged by readings that only check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fit import Fitted, Slopes, Target, fit
from nxt_twin.diagnose.fitting.free_run import FreeRunCheck
from nxt_twin.diagnose.fitting.noise import estimate, with_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.variables import variables_of
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import STEP_S, Simulator

DRAFT_STEP_S = 4e-3
SETTLED_STEP_S = 2e-3
"""Steps while structures are searched and weighed; what is reported is fitted with `STEP_S`. For an NXT motor they err
by less than 5 and 1 nats; an effect with a mechanical state of its own takes half of either."""

_SHARE_ROUNDS = 3
_SHARE_RESTS = 0.03
_SETTLE_ROUNDS = 4
_RESTING_NATS = 1.0
_DRAFT_PATIENCE_NATS = 1.0
_SETTLED_PATIENCE_NATS = 0.2
_EXACT_PATIENCE_NATS = 0.05
_TUNED_KEPT = 8
_POLL_FACTORS = (0.5, 0.7, 0.85, 1.15, 1.4, 2.0)
_POLLED_NATS = 1.0
_MECHANICAL = {"torque", "damping", "friction", "hold"}
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
        believed: how many of those readings were taken for readings rather than for faults.
    """

    fitted: Fitted
    noise: Noise
    check_cost: float
    free_run_rms: tuple[float, float]
    believed: int

    @property
    def plant(self) -> Plant:
        """The fitted plant."""
        return self.fitted.plant

    @property
    def fitted_cost(self) -> float:
        """Of the readings that were fitted and of the priors, nats."""
        return self.fitted.cost + self.fitted.prior_cost


@final
@dataclass(frozen=True)
class Draft:
    """A plant fitted roughly, and the cost of the checking readings under the same noise, nats."""

    fitted: Fitted
    check_cost: float

    @property
    def cost(self) -> float:
        """Of all readings and priors, nats."""
        return self.fitted.cost + self.fitted.prior_cost + self.check_cost


@final
class Workshop:
    """Fits structures for one problem."""

    def __init__(self, simulator: Simulator, problem: Problem) -> None:
        self.simulator = simulator
        self.problem = problem
        self._targets: dict[float, Target] = {STEP_S: problem.target}
        self._tuned: dict[tuple[float, Noise], Target] = {}
        self._free_runs = FreeRunCheck(problem.target.jobs, problem.check, problem.window_s)

    def fit(self, plant: Plant, noise: Noise, *, iterations: int = 12) -> Structure:
        """Fit `plant` on the target's readings under `noise`."""
        step_s = step_for(plant, SETTLED_STEP_S)
        fitted = self._fitted(self.tuned(noise, step_s), plant, iterations, _SETTLED_PATIENCE_NATS)
        return self._judged(fitted, noise, step_s)

    def fit_everything(self, plant: Plant, noise: Noise) -> Structure:
        """Fit `plant` on every reading that is not held out, under the noise that suits it, to the last digit."""
        near = self.roughly_everything(plant, noise, rounds=2)
        tuned = with_noise(self.problem.everything(), near.noise)
        return self._judged(self._fitted(tuned, near.plant, 15, None), near.noise, STEP_S)

    def roughly_everything(self, plant: Plant, noise: Noise, *, rounds: int) -> Structure:
        """The same as for settling; in no `rounds` of suiting it, under just this noise."""
        step_s = step_for(plant, SETTLED_STEP_S)
        target = _with_step(self.problem.everything(), step_s)
        for _ in range(rounds):
            plant = self._fitted(with_noise(target, noise), plant, 15, _SETTLED_PATIENCE_NATS).plant
            noise, _ = estimate(self.simulator, plant, target, noise)
        fitted = self._fitted(with_noise(target, noise), plant, 25, _SETTLED_PATIENCE_NATS)
        return self._judged(fitted, noise, step_s)

    def settle(self, structure: Structure) -> Structure:
        """The structure under the noise that suits it best: noise and parameters in turn until both rest."""
        return self.settled(structure.plant, structure.noise)

    def settled(self, plant: Plant, noise: Noise) -> Structure:
        """`plant` under the noise that suits it best, both searched from what is given."""
        step_s = step_for(plant, SETTLED_STEP_S)
        target = self._target(
            step_for(plant, DRAFT_STEP_S)
        )  # a likelihood that is flat at its best needs no more
        noise, _ = estimate(self.simulator, plant, target, noise)
        fitted, slopes = self._fitted_on(None, self.tuned(noise, step_s), plant, 12, _SETTLED_PATIENCE_NATS)
        noise_rests = False
        for _ in range(_SETTLE_ROUNDS):
            plant, other, gain = fitted.plant, noise, 0.0
            if not noise_rests:
                likelier, gain = estimate(self.simulator, plant, target, noise, near=True)
                noise_rests = gain < _RESTING_NATS
            if noise_rests:
                plant, gain = self._polled(self.tuned(noise, step_for(plant, DRAFT_STEP_S)), fitted)
                if gain < _POLLED_NATS:
                    break
            else:
                other = likelier
            again, slopes = self._fitted_on(
                slopes, self.tuned(other, step_s), plant, 12, _SETTLED_PATIENCE_NATS
            )
            if again.cost + again.prior_cost < fitted.cost + fitted.prior_cost:
                fitted, noise = again, other
            elif noise_rests:
                break
            else:  # what looked likelier by coarse steps is not by these
                noise_rests = True
        return self._judged(fitted, noise, step_s)

    def draft(self, plant: Plant, noise: Noise, *, iterations: int) -> Draft:
        """Fit `plant` roughly under `noise`, on coarse steps: enough to rank it."""
        step_s = step_for(plant, DRAFT_STEP_S)
        target = self.tuned(noise, step_s)
        fitted = self._fitted(target, plant, iterations, _DRAFT_PATIENCE_NATS)
        return Draft(fitted, self._check_cost(fitted.plant, target))

    def draft_cost(self, plant: Plant, noise: Noise, step_s: float) -> tuple[float, float]:
        """Cost of `plant` as it stands on the target's readings and on the checking ones, steps of `step_s`."""
        values, active = plant.vectors()
        target = self.tuned(noise, step_s)
        results = self.simulator.run(values[None], active[None], target.jobs)
        checking = replace(target, counted=self.problem.check)
        return float(target.cost(results)[0]), float(checking.cost(results)[0])

    def draft_costs(self, plants: Sequence[Plant], noise: Noise) -> FloatArray:
        """Costs of plants with the same effects as they stand, on the target's readings, by the steps of a draft."""
        vectors = [plant.vectors() for plant in plants]
        target = self.tuned(noise, step_for(plants[0], DRAFT_STEP_S))
        values, active = (np.array(part) for part in zip(*vectors, strict=True))
        return target.costs(self.simulator, values, active)

    def tuned(self, noise: Noise, step_s: float) -> Target:
        """The target with steps of `step_s` under the gains that suit `noise`; the latest are kept."""
        key = (step_s, noise)
        if key not in self._tuned:
            if len(self._tuned) >= _TUNED_KEPT:
                del self._tuned[next(iter(self._tuned))]
            self._tuned[key] = with_noise(self._target(step_s), noise)
        return self._tuned[key]

    def _target(self, step_s: float) -> Target:
        if step_s not in self._targets:
            self._targets[step_s] = _with_step(self.problem.target, step_s)
        return self._targets[step_s]

    def _fitted(self, tuned: Target, plant: Plant, iterations: int, patience_nats: float | None) -> Fitted:
        return self._fitted_on(None, tuned, plant, iterations, patience_nats)[0]

    def _fitted_on(
        self, slopes: Slopes | None, tuned: Target, plant: Plant, iterations: int, patience_nats: float | None
    ) -> tuple[Fitted, Slopes]:
        """Variables and shares in turn; without a patience to the end, with the covariance."""
        rounds = 0
        while True:
            rounds += 1
            fitted, slopes = fit(
                self.simulator,
                plant,
                variables_of(plant, self.problem.plant, self.problem.scale),
                tuned,
                slopes,
                iterations=iterations,
                patience_nats=_EXACT_PATIENCE_NATS if patience_nats is None else patience_nats,
                covariance=patience_nats is None,
            )
            before, plant = plant, self._withshares(fitted.plant, tuned)
            if rounds == _SHARE_ROUNDS or _shares_rest(before, plant):
                return replace(fitted, plant=plant), slopes
            slopes = replace(slopes, exact=False)  # what is taken for a fault corrects nothing

    def _judged(self, fitted: Fitted, noise: Noise, step_s: float) -> Structure:
        """The fitted plant with what the checking readings say of it.

        Their cost is that under the kindest of a few noises: a structure that fits well is sure of itself; on other
        inputs that must not count against it.
        """
        plant = fitted.plant
        values, active = plant.vectors()
        checking = replace(self._target(step_s), counted=self.problem.check)
        kinder = [replace(noise, disturbance_std=f * noise.disturbance_std) for f in _CHECK_NOISES]
        tuned = [with_noise(checking, one) for one in kinder]
        results = self.simulator.run(values[None], active[None], [job for one in tuned for job in one.jobs])
        size = len(checking.jobs)
        costs = [float(one.cost(results[n * size : (n + 1) * size])[0]) for n, one in enumerate(tuned)]
        rms, believed = self._free_runs.rms(self.simulator, plant, noise, results[:size], step_s)
        return Structure(fitted, noise, min(costs), rms, believed)

    def _polled(self, tuned: Target, fitted: Fitted) -> tuple[Plant, float]:
        """The best of a few plants with one parameter of an effect well away, and its gain, nats.

        Play, stops and thresholds have likelihoods with steps in them, at which a slope leads nowhere.
        """
        plants = [
            _with_total_inertia(fitted.plant, slot, factor)
            for variable in fitted.variables
            for slot in variable.slots[:1]
            if slot not in self.problem.plant.values
            for factor in _POLL_FACTORS
            if variable.lower <= factor * fitted.plant.values[slot] <= variable.upper
        ]
        if not plants:
            return fitted.plant, 0.0
        values, active = (
            np.array(part) for part in zip(*(p.vectors() for p in [*plants, fitted.plant]), strict=True)
        )
        costs = tuned.costs(self.simulator, values, active)
        best = int(np.argmin(costs[:-1]))
        gain = float(costs[-1] - costs[best])
        return (plants[best], gain) if gain > _POLLED_NATS else (fitted.plant, 0.0)

    def moments(self, simpler: Structure, richer: Structure) -> float:
        """In how many moments, of a second each, `richer` gains what it gains, were they all to gain alike.

        Both under the noise of `simpler`: a noise that one moment forced upon a model costs it all the others.
        """
        step_s = step_for(richer.plant, SETTLED_STEP_S)
        tuned = self.tuned(simpler.noise, step_s)
        gains: dict[tuple[str, int], float] = {}
        for sign, structure in ((1.0, simpler), (-1.0, richer)):
            values, active = structure.plant.vectors()
            results = self.simulator.run(values[None], active[None], tuned.jobs)
            for job, result in zip(tuned.jobs, results, strict=True):
                seconds = np.floor(job.signals.time_s - job.signals.time_s[0]).astype(int)
                for second, cost in enumerate(np.bincount(seconds, np.nan_to_num(result.cost[0]))):
                    key = (job.signals.name, second)
                    gains[key] = gains.get(key, 0.0) + sign * float(cost)
        each = np.array(list(gains.values()))
        return float(np.sum(each) ** 2 / max(np.sum(each**2), 1e-12))

    def _check_cost(self, plant: Plant, tuned: Target) -> float:
        values, active = plant.vectors()
        results = self.simulator.run(values[None], active[None], tuned.jobs)
        return float(replace(tuned, counted=self.problem.check).cost(results)[0])

    def _withshares(self, plant: Plant, target: Target) -> Plant:
        """Set the share of each fault to the mean probability with which it explains a reading."""
        if not shares(plant):
            return plant
        values, active = plant.vectors()
        results = self.simulator.run(values[None], active[None], target.jobs)
        doubts = np.concatenate(
            [1.0 - result.weight[0, mask] for result, mask in zip(results, target.seen(), strict=True)]
        )
        new = {}
        for effect in plant.effects:
            if "outlier" in effect.terms:
                share = effect.parameters[0]
                new[Slot(effect.id, share.symbol)] = float(np.clip(doubts.mean(), share.lower, share.upper))
        return plant.with_values(new)


def _with_step(target: Target, step_s: float) -> Target:
    return replace(target, jobs=tuple(replace(job, step_s=step_s) for job in target.jobs))


def step_for(plant: Plant, coarse_s: float) -> float:
    """`coarse_s`, or half of it where an effect has a mechanical state of its own, which may be stiff."""
    stiff = any(is_mechanical(effect) for effect in plant.effects)
    return max(STEP_S, 0.5 * coarse_s) if stiff else coarse_s


def is_mechanical(effect: Effect) -> bool:
    """Whether the effect has a state of its own in the balance of torques, such as a load behind play."""
    return bool(effect.states and _MECHANICAL & effect.terms.keys())


def _with_total_inertia(plant: Plant, slot: Slot, factor: float) -> Plant:
    """One parameter multiplied; where it is a load's inertia, the body makes up for it."""
    value = plant.values[slot]
    new = {slot: factor * value}
    body = Slot(BASE_OWNER, "inertia")
    if slot.symbol == "load_inertia" and plant.values[body] > (factor - 1.0) * value:
        new[body] = plant.values[body] - (factor - 1.0) * value
    return plant.with_values(new)


def _shares_rest(before: Plant, after: Plant) -> bool:
    slots = [Slot(e.id, e.parameters[0].symbol) for e in after.effects if "outlier" in e.terms]
    return all(abs(after.values[s] - before.values[s]) < _SHARE_RESTS * before.values[s] for s in slots)


def shares(plant: Plant) -> int:
    """How many shares of faulty readings `plant` has, which no fit counts among its variables."""
    return sum("outlier" in effect.terms for effect in plant.effects)
