"""Fits plants to the readings of one problem, under a given noise: all that the other rooms ask of a fit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from threading import RLock
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.batch import samples_of
from nxt_twin.diagnose.fitting.checks import Checks
from nxt_twin.diagnose.fitting.fit import Fitted, Slopes, fit
from nxt_twin.diagnose.fitting.noise import drift_of, with_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import DRAFT_STEP_S, SETTLED_STEP_S, Structure, shares, step_for
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.fitting.variables import variables_of
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import STEP_S, Simulator

_SIMULATING_ROUNDS = 3  # of parameters and drift in turn, at most
_DRIFT_RESTS = 0.02  # relative change of the drift at which rounds end
_SHARE_ROUNDS = 3  # of variables and shares of faults in turn, at most
_SHARE_RESTS = 0.03  # relative change of a share at which they end
_TUNED_KEPT = 8  # targets with gains, at most
_KEPT_READINGS = 1_000_000  # of all of them: gains of an hour's readings take 12 MB and more


@final
@dataclass(frozen=True)
class Effort:
    """How closely a plant is fitted.

    Attributes:
        step_s: step of the simulation, for a plant without mechanical states of its effects, s.
        iterations: most steps of the fit.
        patience_nats: the fit rests where the next step would gain less.
        covariance: whether the covariance is measured at the end.
        roughly: whether it may rest on slopes that followed the steps.
    """

    step_s: float
    iterations: int
    patience_nats: float
    covariance: bool = False
    roughly: bool = False

    def step_for(self, plant: Plant) -> float:
        """The step of the simulation for `plant`, s."""
        return step_for(plant, self.step_s)


DRAFTED = Effort(DRAFT_STEP_S, 4, 1.0, roughly=True)
SETTLED = Effort(SETTLED_STEP_S, 12, 0.2)
EXACT = Effort(STEP_S, 15, 0.05, covariance=True)
"""Enough to rank a candidate, enough to weigh a structure, and what is reported."""


@final
class Fitter:
    """Fits plants to one problem's readings; the latest of the targets that suit a noise are kept.

    Attributes:
        simulator, problem: what it was made with.
        on_everything: what `everything.roughly_everything` has fitted, by the plant's identity, noise and rounds;
            each with the plant, so that no other one gets this identity.
    """

    def __init__(self, simulator: Simulator, problem: Problem) -> None:
        self.simulator = simulator
        self.problem = problem
        self._targets: dict[float, Target] = {STEP_S: problem.objective}
        self._tuned: dict[tuple[float, Noise], Target] = {}
        self._keeping = RLock()  # fits go on abreast
        self._checks = Checks(simulator, problem)
        self.on_everything: dict[tuple[int, Noise, int], tuple[Plant, Structure]] = {}

    def fit(
        self, plant: Plant, noise: Noise, effort: Effort = SETTLED, slopes: Slopes | None = None
    ) -> tuple[Fitted, Slopes]:
        """Fit `plant` on the target's readings under `noise`, and give the slopes at which the fit came to rest.

        `slopes` of an earlier fit of a plant with the same effects save the first measurement of them.
        """
        return self.fit_on(self.tuned(noise, effort.step_for(plant)), plant, effort, slopes)

    def fit_on(
        self, tuned: Target, plant: Plant, effort: Effort, slopes: Slopes | None = None
    ) -> tuple[Fitted, Slopes]:
        """As `fit`, on readings whose jobs already have their step and noise: variables and shares in turn."""
        rounds = 0
        while True:
            rounds += 1
            fitted, slopes = fit(
                self.simulator,
                plant,
                variables_of(plant, self.problem.plant, self.problem.scale),
                tuned,
                slopes,
                iterations=effort.iterations,
                patience_nats=effort.patience_nats,
                covariance=effort.covariance,
                roughly=effort.roughly,
            )
            before, plant = plant, self._with_shares(fitted.plant, tuned)
            if rounds == _SHARE_ROUNDS or _shares_rest(before, plant):
                return replace(fitted, plant=plant), slopes
            slopes = replace(slopes, exact=False)  # what is taken for a fault corrects nothing

    def simulating(
        self, plant: Plant, noise: Noise, *, everything: bool = False, rounds: int = _SIMULATING_ROUNDS
    ) -> tuple[Fitted, Noise]:
        """`plant` fitted on windows of simulation alone, and `noise` with how far these are off.

        Of the target's readings, or of `everything` that is not held out. Both are found in turn, for `rounds` at most.
        """
        variables = variables_of(plant, self.problem.plant, self.problem.scale)
        target = self.target(step_for(plant, DRAFT_STEP_S))
        target = target.everything() if everything else target
        patience_nats = SETTLED.patience_nats if everything else DRAFTED.patience_nats
        noise = replace(noise, drift=drift_of(self.simulator, plant, target, noise))
        slopes = None
        for left in reversed(range(rounds)):
            tuned = with_noise(target.simulating(), noise)
            fitted, slopes = fit(  # how far off simulations are changes what a reading weighs, and no slope
                self.simulator,
                plant,
                variables,
                tuned,
                slopes,
                iterations=12,
                patience_nats=patience_nats,
                covariance=False,
                roughly=not everything,
            )
            plant = fitted.plant
            drift = drift_of(self.simulator, plant, target, noise) if left else noise.drift
            if abs(drift - noise.drift) <= _DRIFT_RESTS * drift:
                break
            noise = replace(noise, drift=drift)
        return fitted, noise

    def simulated_error(self, plant: Plant, noise: Noise) -> float:
        """The mean error of all windows of simulation over all that is not held out, SI."""
        return self._checks.simulated_error(plant, noise, step_for(plant, SETTLED_STEP_S))

    def simulated_errors(self, plant: Plant, noise: Noise) -> FloatArray:
        """The mean errors of short windows, windows and whole runs over all that is not held out, SI."""
        return self._checks.simulated_errors(plant, noise, step_for(plant, SETTLED_STEP_S))

    def checked(self, fitted: Fitted, noise: Noise, effort: Effort = SETTLED) -> Structure:
        """The fitted plant with what the checking readings say of it."""
        return self._checks.checked(fitted, noise, effort.step_for(fitted.plant))

    def target(self, step_s: float) -> Target:
        """The target with steps of `step_s`."""
        with self._keeping:
            if step_s not in self._targets:
                self._targets[step_s] = self.problem.objective.with_step(step_s)
            return self._targets[step_s]

    def tuned(self, noise: Noise, step_s: float) -> Target:
        """The target with steps of `step_s` under the gains that suit `noise`; the latest are kept."""
        key = (step_s, noise)
        with self._keeping:
            if key not in self._tuned:
                readings = samples_of(self.problem.objective.jobs)
                if len(self._tuned) >= min(_TUNED_KEPT, max(1, _KEPT_READINGS // max(readings, 1))):
                    del self._tuned[next(iter(self._tuned))]
                self._tuned[key] = with_noise(self.target(step_s), noise)
            return self._tuned[key]

    def _with_shares(self, plant: Plant, target: Target) -> Plant:
        """Set the share of each fault to the mean probability with which it explains a reading."""
        if not shares(plant):
            return plant
        values, active = plant.vectors()
        target = target.predicting()
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


def _shares_rest(before: Plant, after: Plant) -> bool:
    slots = [Slot(e.id, e.parameters[0].symbol) for e in after.effects if "outlier" in e.terms]
    return all(abs(after.values[s] - before.values[s]) < _SHARE_RESTS * before.values[s] for s in slots)
