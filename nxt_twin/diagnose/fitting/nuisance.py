"""Residuals of a structure and the slopes by its own variables, which can imitate what another plant would change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.batch import batch_predictions, batches, samples_of
from nxt_twin.diagnose.fitting.fit import Variable, values_of
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.fitting.variables import variables_of
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Result

_LARGEST_STRETCH = 4.0  # of a start along its linear gain: further away it is not linear
_LARGEST_SIGNATURE = 1e4  # in standard deviations; a run that blew up is no better than that
_DIFFERENCE = 2e-3  # between parameter sets of a slope, in units of a variable


@final
class Nuisance:
    """Residuals of the structure at its values, and the slopes of its own variables, which can imitate an effect.

    Attributes:
        jobs: the recordings whose readings are evidence.
        masks: which samples of each count, shape (samples,).
        residual: of those, in standard deviations, by job.
        slopes: of their predictions by each variable, in standard deviations, shape (variables, readings), by job.
        gradient: slopes · residuals, shape (variables,).
    """

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
        self.jobs = target.jobs
        self.masks = target.seen()
        predicted, last = batch_predictions(
            self._simulator, values, self._believing(active), target.jobs, self.masks
        )
        self._cost = float(target.cost(last)[0])
        self._base = [own[-1].copy() for own in predicted]
        self._inverse: list[FloatArray] = []
        self.residual: list[FloatArray] = []
        self.slopes: list[FloatArray] = []
        hessian = np.diag([(v.scale / v.spread) ** 2 for v in variables])
        gradient = np.zeros(len(variables))
        jobs = zip(target.jobs, self.masks, predicted, weighed, strict=True)
        for number, (job, seen, moved, own) in enumerate(jobs):
            weight = target.evidence[number] * target.weight(number, own)[0, seen]
            inverse = np.sqrt(weight) / job.observer.innovation_std[seen]
            residual = _bounded((job.signals.measured[seen] - own.predicted[0, seen]) * inverse)
            slopes = _bounded((moved[:-1] - moved[-1]) * inverse) / _DIFFERENCE
            hessian += slopes @ slopes.T
            gradient += slopes @ residual
            self._inverse.append(inverse)
            self.residual.append(residual)
            self.slopes.append(slopes)
        self._solve = np.linalg.pinv(hessian, hermitian=True)
        self.gradient = gradient

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

    def signatures(self, plants: Sequence[Plant]) -> list[FloatArray]:
        """The change of all predictions under each of `plants`, in standard deviations, shape (plants, readings)."""
        return self._signatures(self._run(plants))

    def projected(
        self, fit: FloatArray, power: FloatArray, along: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """`fit` and `power` of signatures less what the structure's variables imitate of them, shape (signatures,).

        Args:
            fit: signature · residual.
            power: signature · signature.
            along: signature · slopes, shape (signatures, variables).
        """
        imitated = np.einsum("ij,jk,ik->i", along, self._solve, along)
        return fit - along @ self._solve @ self.gradient, power - imitated

    def _run(self, plants: Sequence[Plant]) -> list[Result]:
        vectors = [plant.vectors() for plant in plants]
        values = np.array([values for values, _ in vectors])
        active = np.array([active for _, active in vectors])
        return self._simulator.run(values, self._believing(active), self._target.jobs)

    def _signatures(self, results: Sequence[Result]) -> list[FloatArray]:
        parts = zip(results, self._base, self.masks, self._inverse, strict=True)
        return [
            _bounded((result.predicted[:, mask] - base) * inverse) for result, base, mask, inverse in parts
        ]

    def _gains_of_batch(self, plants: Sequence[Plant]) -> list[tuple[float, float]]:
        results = self._run(plants)
        along = np.zeros((len(plants), self.gradient.size))  # signature · slopes
        fit, power = (
            np.zeros(len(plants)),
            np.zeros(len(plants)),
        )  # signature · residual, signature · signature
        for signature, residual, slopes in zip(
            self._signatures(results), self.residual, self.slopes, strict=True
        ):
            along += signature @ slopes.T
            fit += signature @ residual
            power += np.einsum("ij,ij->i", signature, signature)
        believed = fit - 0.5 * power  # what is gained outright in readings that the structure does not doubt
        fit, power = self.projected(fit, power, along)
        stretch = np.clip(fit / np.maximum(power, 1e-9), 0.0, _LARGEST_STRETCH)
        linear = stretch * fit - 0.5 * stretch**2 * power
        outright = believed
        if not self._outliers:
            outright = np.nan_to_num(self._cost - self._target.cost(results), neginf=-1e9)
        gains = np.maximum(linear, outright)
        doubting = np.array([self._has_outliers_of_its_own(plant) for plant in plants])
        stretch = np.where((outright > linear) & ~doubting, 1.0, stretch)
        return [(float(gain), float(by)) for gain, by in zip(gains, stretch, strict=True)]


def _bounded(deviations: FloatArray) -> FloatArray:
    """`deviations`, in standard deviations, of runs that may have blown up: finite, so that their squares are."""
    return np.clip(np.nan_to_num(deviations), -_LARGEST_SIGNATURE, _LARGEST_SIGNATURE)


def _shifted(plant: Plant, variables: Sequence[Variable]) -> tuple[FloatArray, BoolArray]:
    """Value vectors with one variable after another moved by a little, the plant itself last."""
    values, active = plant.vectors()
    sets = np.repeat(values[None], len(variables) + 1, axis=0)
    index = plant.layout.index
    for row, (variable, x) in enumerate(zip(variables, values_of(plant, variables), strict=True)):
        for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
            sets[row, index[slot]] = (x + _DIFFERENCE * variable.scale) * ratio
    return sets, np.repeat(active[None], len(variables) + 1, axis=0)
