"""Every start of every effect tried in one run each: what it promises, once the rest has been re-fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.batch import batches, predictions, samples_of
from nxt_twin.diagnose.fitting.fit import Target, Variable, values_of
from nxt_twin.diagnose.fitting.fitter import DRAFTED, Fitter
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.fitting.variables import starts_of, variables_of
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant

_LARGEST_STRETCH = 4.0
_LARGEST_SIGNATURE = 1e4  # in standard deviations; a run that blew up is no better than that
_DIFFERENCE = 2e-3


@final
@dataclass(frozen=True)
class Prospect:
    """An effect added to a plant at one of its starts, the gain that it promises, nats, and stretched by how much."""

    effect: Effect
    plant: Plant
    gain: float
    stretch: float

    def stretched(self, scale: Scale) -> Plant:
        """The plant with the effect's main parameter stretched from where it begins to count, within its bounds."""
        main = self.effect.parameters[0]
        bounds = main.in_frame(self.plant.layout.frame).scaled(scale)
        slot = Slot(self.effect.id, main.symbol)
        nothing = self.plant.values.get(Slot(*main.above), 0.0) if main.above else 0.0
        value = nothing + self.stretch * (self.plant.values[slot] - nothing)
        value = float(np.clip(value, bounds.lower * bounds.si, bounds.upper * bounds.si))
        return self.plant.with_values({slot: value})


def screen(fitter: Fitter, structure: Structure, effects: Sequence[Effect]) -> list[Prospect]:
    """The gain that each start of each of `effects` promises beside `structure`, likeliest first.

    One run a start gives the signature: the change of all predictions in standard deviations. A score test
    with nuisance parameters projects out all that a re-fit of the structure's own variables could imitate.
    The rest is scaled, since a start has only the order of magnitude.
    """
    plants = [
        (effect, _with_load_split(structure.plant.with_effect(effect.id, start), effect))
        for effect in effects
        for start in starts_of(effect, fitter.problem.scale)
    ]
    found = []
    steps_s = {DRAFTED.step_for(plant) for _, plant in plants}
    for step_s in sorted(steps_s):
        some = [(effect, plant) for effect, plant in plants if DRAFTED.step_for(plant) == step_s]
        nuisance = _Nuisance(fitter, structure, fitter.tuned(structure.noise, step_s))
        gains = nuisance.gains([plant for _, plant in some])
        found += [Prospect(*one, *promise) for one, promise in zip(some, gains, strict=True)]
    return sorted(found, key=lambda prospect: -prospect.gain)


@final
class _Nuisance:
    """What the structure's own variables can imitate: residuals and slopes at its values."""

    def __init__(self, fitter: Fitter, structure: Structure, target: Target) -> None:
        self._simulator = fitter.simulator
        self._target = target
        plant = structure.plant
        variables = variables_of(plant, fitter.problem.plant, fitter.problem.scale)
        values, active = _shifted(plant, variables)
        self._active = plant.active
        self._outliers = [
            n for n, e in enumerate(plant.layout.effects) if "outlier" in e.terms and e.id in plant.active
        ]
        weighed = self._simulator.run(values[-1:], active[-1:], target.jobs)
        self._masks = target.seen()
        predicted, last = predictions(
            self._simulator, values, self._believing(active), target.jobs, self._masks
        )
        self._cost = float(target.cost(last)[0])
        self._base = [own[-1].copy() for own in predicted]
        self._inverse: list[FloatArray] = []
        self._residual: list[FloatArray] = []
        self._slopes: list[FloatArray] = []
        hessian = np.diag([(v.scale / v.spread) ** 2 for v in variables])
        gradient = np.zeros(len(variables))
        jobs = zip(target.jobs, self._masks, predicted, weighed, strict=True)
        for number, (job, seen, moved, own) in enumerate(jobs):
            weight = target.evidence[number] * target.weight(number, own)[0, seen]
            inverse = np.sqrt(weight) / job.observer.innovation_std[seen]
            residual = (job.signals.measured[seen] - own.predicted[0, seen]) * inverse
            slopes = np.nan_to_num((moved[:-1] - moved[-1]) * inverse)
            slopes /= _DIFFERENCE
            hessian += slopes @ slopes.T
            gradient += slopes @ residual
            self._inverse.append(inverse)
            self._residual.append(residual)
            self._slopes.append(slopes)
        self._solve = np.linalg.pinv(hessian, hermitian=True)
        self._gradient = gradient

    def gains(self, plants: Sequence[Plant]) -> list[tuple[float, float]]:
        """What each of the plants promises, nats, and stretched by how much."""
        parts = batches(len(plants), samples_of(self._target.jobs))
        return [gain for part in parts for gain in self._gains_of_batch(plants[part])]

    def _believing(self, active: BoolArray) -> BoolArray:
        """`active` without the structure's own model of outliers.

        A start that is far off would take every reading for an outlier, and would never be set right again.
        """
        believing = active.copy()
        believing[:, self._outliers] = False
        return believing

    def _has_outliers_of_its_own(self, plant: Plant) -> bool:
        return any("outlier" in e.terms and e.id not in self._active for e in plant.effects)

    def _gains_of_batch(self, plants: Sequence[Plant]) -> list[tuple[float, float]]:
        vectors = [plant.vectors() for plant in plants]
        values = np.array([values for values, _ in vectors])
        active = np.array([active for _, active in vectors])
        results = self._simulator.run(values, self._believing(active), self._target.jobs)
        along = np.zeros((len(plants), self._gradient.size))  # signature · slopes
        fit, power = (
            np.zeros(len(plants)),
            np.zeros(len(plants)),
        )  # signature · residual, signature · signature
        parts = zip(
            results, self._base, self._masks, self._inverse, self._residual, self._slopes, strict=True
        )
        for result, base, mask, inverse, residual, slopes in parts:
            signature = np.clip(
                np.nan_to_num((result.predicted[:, mask] - base) * inverse),
                -_LARGEST_SIGNATURE,
                _LARGEST_SIGNATURE,
            )
            along += signature @ slopes.T
            fit += signature @ residual
            power += np.einsum("ij,ij->i", signature, signature)
        fit -= along @ self._solve @ self._gradient
        power -= np.einsum("ij,jk,ik->i", along, self._solve, along)
        stretch = np.clip(fit / np.maximum(power, 1e-9), 0.0, _LARGEST_STRETCH)
        linear = stretch * fit - 0.5 * stretch**2 * power
        outright = np.nan_to_num(self._cost - self._target.cost(results), neginf=-1e9)
        doubting = np.array([self._has_outliers_of_its_own(plant) for plant in plants])
        gains = np.where(
            doubting, np.maximum(linear, outright), linear
        )  # likelihoods changed, not predictions
        return [(float(gain), float(by)) for gain, by in zip(gains, stretch, strict=True)]


def _shifted(plant: Plant, variables: Sequence[Variable]) -> tuple[FloatArray, BoolArray]:
    """Value vectors with one variable after another moved by a little, the plant itself last."""
    values, active = plant.vectors()
    sets = np.repeat(values[None], len(variables) + 1, axis=0)
    index = plant.layout.index
    for row, (variable, x) in enumerate(zip(variables, values_of(plant, variables), strict=True)):
        for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
            sets[row, index[slot]] = (x + _DIFFERENCE * variable.scale) * ratio
    return sets, np.repeat(active[None], len(variables) + 1, axis=0)


def _with_load_split(plant: Plant, effect: Effect) -> Plant:
    """Take a new load's inertia off the body, which has carried it until now."""
    load = Slot(effect.id, "load_inertia")
    if load not in plant.values:
        return plant
    body = Slot(BASE_OWNER, "inertia")
    total = plant.values[body]
    share = plant.values[load] / (plant.values[load] + plant.layout.parameters[body].starts[0])
    return plant.with_values({body: (1.0 - share) * total, load: share * total})
