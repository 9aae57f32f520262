"""Fit a plant's parameters to recordings: Levenberg-Marquardt on innovations, every simulation in a batch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.batch import batch_predictions, one_of
from nxt_twin.diagnose.fitting.likeness import most_likely, told_apart
from nxt_twin.diagnose.fitting.tamed import tamed
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Result, Simulator

_DAMPINGS = (0.0, 1e-2, 1.0, 30.0)
_DIFFERENCE = 2e-3  # between parameter sets of a slope, in units of a variable
_PATIENCE_NATS = 0.05  # a fit rests where the next step would gain less
_LEAST_SHARE = 1e-3  # of its scale: the least value of a positive variable
_LONGEST_LOG_STEP = 1.0  # of one step, as a logarithm: slopes say little further away
_TRUSTED = 0.5  # of the gain that was promised: slopes that give less are measured anew


@final
@dataclass(frozen=True)
class Variable:
    """One direction in which a fit may move: the parameters that move together, in fixed proportion.

    Attributes:
        slots: the parameters, the first of which gives the variable's value (SI).
        ratios: value of each over that of the first.
        scale: an ordinary size of the value, SI.
        lower, upper: bounds, SI.
        centre, spread: mean and standard deviation of the weak prior, SI; spread inf is no prior.
        likeness: the power with which the value grows along the motors that these readings cannot tell apart.
        shared_out: whether the value is a share of which none is as ordinary as a part.

    A positive value moves by factors: its prior is normal in its logarithm.
    """

    slots: tuple[Slot, ...]
    ratios: tuple[float, ...]
    scale: float
    lower: float
    upper: float
    centre: float
    spread: float
    likeness: float = 0.0
    shared_out: bool = False

    @property
    def positive(self) -> bool:
        """Whether the value can only be positive and is hardly nothing, so that a fit moves its logarithm."""
        return self.lower >= 0.0 and not self.shared_out

    def times(self, value: float, factor: float) -> float:
        """A `value` that is another by a factor; of a share, by as much as the factor is in its logarithm."""
        if not self.shared_out:
            return value * factor
        return min(max(value + math.log(factor), self.lower), self.upper)


@final
@dataclass(frozen=True)
class Fitted:
    """A plant at its best parameters.

    Attributes:
        plant: with the fitted values.
        variables: what was moved.
        covariance: of the variables, SI, shape (variables, variables).
        cost: negative log-likelihood of the readings that were fitted, nats.
        prior_cost: what the weak priors add.
        readings: how many were fitted.
    """

    plant: Plant
    variables: tuple[Variable, ...]
    covariance: FloatArray
    cost: float
    prior_cost: float
    readings: int


def values_of(plant: Plant, variables: Sequence[Variable]) -> FloatArray:
    """The variables' values in `plant`, SI, shape (variables,)."""
    return np.array([plant.values[v.slots[0]] for v in variables])


def plant_at(plant: Plant, variables: Sequence[Variable], x: FloatArray) -> Plant:
    """`plant` with its variables set to `x`."""
    new = {
        slot: float(value) * ratio
        for variable, value in zip(variables, x, strict=True)
        for slot, ratio in zip(variable.slots, variable.ratios, strict=True)
    }
    return plant.with_values(new)


def fit(
    simulator: Simulator,
    plant: Plant,
    variables: Sequence[Variable],
    target: Target,
    slopes: Slopes | None = None,
    *,
    iterations: int,
    patience_nats: float = _PATIENCE_NATS,
    covariance: bool,
    roughly: bool = False,
) -> tuple[Fitted, Slopes]:
    """Move `variables` of `plant` to the most likely values, given the target's readings and the weak priors.

    Slopes are measured at the start and wherever a step gives less than they promised, and follow the steps otherwise.
    A caller may pass slopes from an earlier fit of these variables on these readings. They hold while the
    noise has changed little; inexact slopes are measured anew before the fit ends, unless it is to fit `roughly`.
    Stops after a number of `iterations`, or where the next would gain less than `patience_nats`. Without `covariance`
    that of the last step stands in for the one at the end, which takes twice as many runs.
    """
    target = target.telling()
    search = _FitSurroundings(simulator, plant, tuple(variables), target.pulling())
    x: FloatArray = search.centred(search.inside(values_of(plant, variables)))
    slopes = search.slopes(x) if slopes is None else search.brought(slopes, x)
    objective, left = search.objective_of(x, slopes), iterations if variables else 0
    while left > 0:
        hessian, gradient = search.normal_equations(x, slopes)
        free = search.free(x, gradient)
        steps = np.array([_step(hessian, gradient, free, damping) for damping in _DAMPINGS])
        promised = -0.5 * float(gradient @ steps[0])
        gain, exact = 0.0, slopes.exact
        if promised >= patience_nats:
            left -= 1
            trials: FloatArray = np.clip(x + search.bounded(steps), search.lower, search.upper)
            results = search.run(trials)
            objectives = search.objectives(trials, results)
            best = int(np.nanargmin(objectives))
            gain = objective - float(objectives[best])
            if gain > 0.0:
                slopes = search.followed(
                    slopes, trials[best] - x, [one_of(result, best) for result in results]
                )
                x, objective = trials[best], float(objectives[best])
        if gain < patience_nats and (exact or (roughly and promised < patience_nats)):
            break
        if gain < max(patience_nats, _TRUSTED * promised) and left > 0:
            slopes = search.slopes(x, slopes.results)
    x = search.centred(x)
    hessian, _ = search.normal_equations(x, search.slopes(x, central=True) if covariance else slopes)
    spread = np.asarray(np.linalg.pinv(np.nan_to_num(hessian), hermitian=True), dtype=np.float64)
    width = search.scale * search.si_per_unit(x)
    fitted = Fitted(
        plant_at(plant, variables, search.si(x)),
        tuple(variables),
        spread * np.outer(width, width),
        float(target.cost(slopes.results)[0]),
        search.prior_cost(x),
        target.worth(),
    )
    return fitted, slopes


def _step(hessian: FloatArray, gradient: FloatArray, free: BoolArray, damping: float) -> FloatArray:
    """The step of the `free` variables; all others stay. Where a run ran away and has no slope, every one stays."""
    step = np.zeros(gradient.size)
    if not (np.isfinite(hessian).all() and np.isfinite(gradient).all()):
        return step
    inside = hessian[np.ix_(free, free)]
    damped = inside + damping * np.diag(np.maximum(np.diag(inside), 1e-12))
    step[free] = np.linalg.lstsq(damped, -gradient[free], rcond=1e-12)[0]
    return step


@final
@dataclass(frozen=True)
class Slopes:
    """How predictions move with the variables, around one point.

    Attributes:
        predicted: change of the counted readings' predictions for each variable, divided by its scale, by job, shape
            (variables, readings).
        results: the runs at the point itself.
        exact: whether the slopes are differences at this point rather than older ones that followed the steps.
    """

    predicted: tuple[FloatArray, ...]
    results: tuple[Result, ...]
    exact: bool


@final
class _FitSurroundings:
    """The fixed surroundings of one fit.

    Inside, positive variables are logarithms; all are divided by their scale where they meet a linear equation.
    """

    def __init__(
        self, simulator: Simulator, plant: Plant, variables: tuple[Variable, ...], target: Target
    ) -> None:
        self._simulator = simulator
        self._target = target
        self._values, self._active = plant.vectors()
        index = plant.layout.index
        self._columns = [[index[slot] for slot in v.slots] for v in variables]
        self._ratios = [np.array(v.ratios) for v in variables]
        self._log = np.array([v.positive for v in variables], dtype=bool)
        self._least = np.array([max(v.lower, _LEAST_SHARE * v.scale) for v in variables])
        self.scale = np.array([1.0 if v.positive else v.scale for v in variables])
        self.lower = self.inside(np.array([v.lower for v in variables]))
        self.upper = self.inside(np.array([v.upper for v in variables]))
        self._likeness = np.array([v.likeness for v in variables])
        self._centre = self.inside(np.array([v.centre for v in variables]))
        relative = np.array([v.scale if v.positive else 1.0 for v in variables])
        self._spread = np.array([v.spread for v in variables]) / relative
        self._counted = target.seen()

    def inside(self, si: FloatArray) -> FloatArray:
        """Values as the search moves them, from SI."""
        found = np.array(si, dtype=np.float64)
        found[self._log] = np.log(np.maximum(found[self._log], self._least[self._log]))
        return found

    def si(self, x: FloatArray) -> FloatArray:
        """Values in SI, of shape (…, variables)."""
        found = np.array(x, dtype=np.float64)
        found[..., self._log] = np.exp(found[..., self._log])
        return found

    def si_per_unit(self, x: FloatArray) -> FloatArray:
        """How fast the SI value grows with the one that is moved."""
        return np.where(self._log, self.si(x), 1.0)

    def bounded(self, steps: FloatArray) -> FloatArray:
        """Steps, in scales, as moves; no logarithm by more than a factor that slopes can still tell of."""
        moves = steps * self.scale
        moves[..., self._log] = np.clip(moves[..., self._log], -_LONGEST_LOG_STEP, _LONGEST_LOG_STEP)
        return np.asarray(moves)

    def run(self, x: FloatArray) -> list[Result]:
        return self._simulator.run(*self._sets(x), self._target.jobs)

    def _sets(self, x: FloatArray) -> tuple[FloatArray, BoolArray]:
        x = self.si(x)
        values = np.repeat(self._values[None], x.shape[0], axis=0)
        for i, (columns, ratios) in enumerate(zip(self._columns, self._ratios, strict=True)):
            values[:, columns] = x[:, i : i + 1] * ratios
        return values, np.repeat(self._active[None], x.shape[0], axis=0)

    def objectives(self, x: FloatArray, results: Sequence[Result]) -> FloatArray:
        prior = 0.5 * (((x - self._centre) / self._spread) ** 2).sum(axis=1)
        return np.asarray(self._target.cost(results) + prior)

    def prior_cost(self, x: FloatArray) -> float:
        return float(0.5 * (((x - self._centre) / self._spread) ** 2).sum())

    def centred(self, x: FloatArray) -> FloatArray:
        """The likeliest of the motors that these readings cannot tell from `x`."""
        found = most_likely(x, self._likeness, self._centre, self._spread, self._log)
        return np.asarray(np.clip(found, self.lower, self.upper))

    def free(self, x: FloatArray, gradient: FloatArray) -> BoolArray:
        """Which variables a step may move: not those at a bound beyond which they are drawn."""
        held = ((x <= self.lower) & (gradient > 0.0)) | ((x >= self.upper) & (gradient < 0.0))
        return np.asarray(~held)

    def slopes(
        self, x: FloatArray, known: Sequence[Result] | None = None, *, central: bool = False
    ) -> Slopes:
        """By one-sided differences, which do for a step, or by central ones, which a covariance needs.

        `known` are the runs at `x`, if there are any.
        """
        size = x.size
        step = _DIFFERENCE * np.where(self._log, 1.0, np.maximum(np.abs(x), 0.1 * self.scale))
        ahead = np.where(x + step <= self.upper, x + step, np.maximum(x - step, self.lower))
        behind = np.maximum(x - step, self.lower) if central else x
        sets = np.repeat(x[None], size * (2 if central else 1) + (known is None), axis=0)
        sets[np.arange(size), np.arange(size)] = ahead
        if central:
            sets[size + np.arange(size), np.arange(size)] = behind
        width = np.where(ahead == behind, np.inf, ahead - behind) / self.scale
        found = []
        predicted, last = batch_predictions(
            self._simulator, *self._sets(sets), self._target.jobs, self._counted
        )
        here = tuple(known or last)
        for own, result, mask in zip(predicted, here, self._counted, strict=True):
            below = own[size : 2 * size] if central else result.predicted[0, mask]
            found.append(tamed((own[:size] - below) / width[:, None]))
        return Slopes(tuple(found), here, exact=True)

    def brought(self, slopes: Slopes, x: FloatArray) -> Slopes:
        """Slopes from under other noise or other shares of faults, with the run of these."""
        return replace(slopes, results=tuple(self.run(x[None])))

    def followed(self, slopes: Slopes, move: FloatArray, results: Sequence[Result]) -> Slopes:
        """The slopes after a `move` of the variables, made to agree with what it did (Broyden's update)."""
        scaled = move / self.scale
        along = scaled / max(float(scaled @ scaled), 1e-300)
        found = []
        for slope, before, after, mask in zip(
            slopes.predicted, slopes.results, results, self._counted, strict=True
        ):
            missed = after.predicted[0, mask] - before.predicted[0, mask] - scaled @ slope
            found.append(tamed(slope + along[:, None] * np.nan_to_num(missed)))
        return Slopes(tuple(found), tuple(results), exact=False)

    def objective_of(self, x: FloatArray, slopes: Slopes) -> float:
        return float(self.objectives(x[None], slopes.results)[0])

    def normal_equations(self, x: FloatArray, slopes: Slopes) -> tuple[FloatArray, FloatArray]:
        """Gauss-Newton Hessian and gradient of the objective in scaled variables."""
        tightness = (self.scale / self._spread) ** 2
        hessian = np.diag(tightness)
        gradient = tightness * (x - self._centre) / self.scale
        for number, (job, slope, result, mask) in enumerate(
            zip(self._target.jobs, slopes.predicted, slopes.results, self._counted, strict=True)
        ):
            weight = self._target.evidence[number] * self._target.weight(number, result)[0, mask]
            inverse = np.sqrt(weight) / job.observer.innovation_std[mask]
            weighted = told_apart(slope, self._likeness * np.where(self._log, 1.0, x / self.scale)) * inverse
            residual = (job.signals.measured[mask] - result.predicted[0, mask]) * inverse
            hessian += weighted @ weighted.T
            gradient -= weighted @ tamed(residual)
        return hessian, gradient
