"""Both sides fitted together: Gauss-Newton on windows of simulation, under the error that they have."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.changed.sides import Side, Which
from nxt_twin.diagnose.fitting.batch import batch_predictions, batches, samples_of
from nxt_twin.diagnose.fitting.losses import SOFT
from nxt_twin.physics.simulate import Simulator

_DIFFERENCE = 2e-3  # step of a slope, in ordinary sizes of a number
_WIDE_DIFFERENCE = (
    0.05  # a load behind play strikes now or a moment later: small steps do not show where it goes
)
_DAMPINGS = (0.0, 1e-2, 1.0, 30.0)
_LONGEST_STEP = 1.0  # of one Gauss-Newton step, in ordinary sizes of a number
_ROUNDS = 3  # of numbers and error in turn, at most
_ITERATIONS = 8  # Gauss-Newton steps of one round, at most
_PATIENCE_NATS = 0.1  # numbers rest where a step gains less
_SAME_ERROR = 0.02  # change of the error, as a logarithm, below which rounds end
_ERROR_ROUNDS = 20  # of the fixed point that the likeliest error is
_POLLS = 3  # and fits from there, at most
_POLL_FACTORS = (0.5, 0.7, 0.85, 1.15, 1.4, 2.0)
_POLLED_NATS = 1.0  # gain from which polled numbers are worth another fit
_LARGEST_ERROR = 1e6  # SI: what a reading is predicted to be where a simulation gives no number


@final
@dataclass(frozen=True)
class JointFit:
    """A model at its best numbers.

    Attributes:
        model: what is shared and what differs.
        x: its numbers.
        error: of simulated readings, SI: the likeliest, but never less than readings allow.
        cost: negative log-likelihood of the fitted readings and of the priors, nats.
        check_cost: negative log-likelihood of the readings that only check, nats.
        check_rms: error of windows that only check, SI, by side.
    """

    model: Model
    x: FloatArray
    error: float
    cost: float
    check_cost: float
    check_rms: tuple[float, ...]


@final
@dataclass(frozen=True)
class JointSlopes:
    """Residuals over the error and slopes for each number of a model, by side.

    Attributes:
        residual: shape (readings,) by side.
        slope: shape (numbers of the side, readings): the shared ones, and after those of its effects.
    """

    residual: tuple[FloatArray, ...]
    slope: tuple[FloatArray, ...]


@final
class JointFitter:
    """Fits models to one or two sides: before, and after where there are two.

    Args:
        simulator: of the plant's layout.
        sides: to be fitted together.
        tolerance: error of a simulation that does not matter, SI.
        as_read: the least error that readings can have, SI: what does not matter may still tell causes apart.
    """

    def __init__(
        self, simulator: Simulator, sides: Sequence[Side], tolerance: float, as_read: float | None = None
    ) -> None:
        self.simulator = simulator
        self.sides = tuple(sides)
        self.tolerance = tolerance
        self.as_read = tolerance if as_read is None else as_read

    def fit(self, model: Model, x: FloatArray, which: Which = "fitted") -> JointFit:
        """Move the numbers of `model` from `x` to the likeliest ones, given the readings of one use."""
        x, error = self._settled(model, x, which)
        for _ in range(_POLLS if model.remembers else 0):
            elsewhere = self._polled(model, x, error, which)
            if elsewhere is None:
                break
            polled = self._settled(model, elsewhere, which)
            costs = [self._objectives(model, own[None], e, which)[0] for own, e in ((x, error), polled)]
            if costs[1] > costs[0] - _POLLED_NATS:
                break
            x, error = polled
        centre, spread = model.priors()
        prior = 0.5 * float((((x - centre) / spread) ** 2).sum())
        check_rms = tuple(
            window_rms(side, self.run(model, x[None], n, "check")[0]) for n, side in enumerate(self.sides)
        )
        cost = self._costs(model, x[None], error, which)[0] + prior
        return JointFit(
            model, x, error, float(cost), float(self._costs(model, x[None], error, "check")[0]), check_rms
        )

    def _settled(self, model: Model, x: FloatArray, which: Which) -> tuple[FloatArray, float]:
        """Numbers and error in turn, until both rest."""
        x = np.clip(x, *model.bounds())
        error = self._error(model, x, which)
        for _ in range(_ROUNDS):
            x = self._moved(model, x, error, which)
            before, error = error, self._error(model, x, which)
            if abs(math.log(error / before)) < _SAME_ERROR:
                break
        return x, error

    def _polled(self, model: Model, x: FloatArray, error: float, which: Which) -> FloatArray | None:
        """The likeliest of the numbers with one of an effect that remembers well away from `x`, where it gains enough.

        Play has a likelihood with steps in it, at which a slope leads nowhere.
        """
        low, high = model.bounds()
        own = _remembering(model)
        trials = np.repeat(x[None], len(own) * len(_POLL_FACTORS), axis=0)
        rows, moves = np.arange(len(trials)), np.tile(np.log(_POLL_FACTORS), len(own))
        trials[rows, np.repeat(own, len(_POLL_FACTORS))] += moves
        trials = np.clip(trials, low, high)
        if not len(trials):
            return None
        costs = self._objectives(model, np.vstack([trials, x]), error, which)
        best = int(np.argmin(costs[:-1]))
        return trials[best] if costs[-1] - costs[best] > _POLLED_NATS else None

    def worth(self, which: Which = "fitted") -> float:
        """How many independent readings there are."""
        return sum(side.worth(which) for side in self.sides)

    def covariance(self, joint: JointFit, which: Which = "everything") -> FloatArray:
        """Of the numbers, inside."""
        hessian, _ = self.normal_equations(
            joint.model, joint.x, self.slopes(joint.model, joint.x, joint.error, which), which
        )
        return np.asarray(np.linalg.pinv(hessian, hermitian=True))

    def run(self, model: Model, x: FloatArray, side: int, which: Which) -> FloatArray:
        """What each set predicts for a side's readings of one use, shape (sets, readings).

        Where an effect remembers, as a load behind play does, each set starts its windows from its own states.
        """
        own, masks = self.sides[side], self.sides[side].masks(which)
        values, active = model.values(x, after=side == 1)
        if model.remembers:
            found = _own_predictions(self.simulator, values, active, own, masks)
        else:  # all from the states that the last one has reached
            jobs = [only for (only,) in own.with_states(self.simulator, values[-1:], active[-1:])]
            found, _ = batch_predictions(self.simulator, values, active, jobs, masks)
        return np.nan_to_num(np.concatenate(found, axis=1), nan=_LARGEST_ERROR)

    def slopes(self, model: Model, x: FloatArray, error: float, which: Which) -> JointSlopes:
        """By one-sided differences, in errors per unit of the numbers inside."""
        count, residuals, slopes = len(model.shared), [], []
        for n, side in enumerate(self.sides):
            extra = list(range(count + len(model.differs), model.size)) if n == 1 else []
            rows = [*range(count), *extra]
            steps = _steps(model, x)
            sets = np.repeat(x[None], len(rows) + 1, axis=0)
            sets[np.arange(len(rows)), rows] += steps[rows]
            found = self.run(model, sets, n, which)
            slopes.append((found[:-1] - found[-1]) / steps[rows][:, None] / error)
            residuals.append((side.measured(which) - found[-1]) / error)
        return JointSlopes(tuple(residuals), tuple(slopes))

    def normal_equations(
        self, model: Model, x: FloatArray, slopes: JointSlopes, which: Which
    ) -> tuple[FloatArray, FloatArray]:
        """Gauss-Newton Hessian and gradient of the cost."""
        centre, spread = model.priors()
        hessian = np.diag(spread**-2.0)
        gradient = (x - centre) / spread**2
        for n, side in enumerate(self.sides):
            weight = side.weight(which) / np.sqrt(1.0 + (slopes.residual[n] / SOFT) ** 2)
            design = design_of(model, slopes.slope[n], after=n == 1)
            hessian += (design * weight) @ design.T
            gradient -= design @ (weight * slopes.residual[n])
        return hessian, gradient

    def _moved(self, model: Model, x: FloatArray, error: float, which: Which) -> FloatArray:
        low, high = model.bounds()
        objective = self._objectives(model, x[None], error, which)[0]
        for _ in range(_ITERATIONS):
            hessian, gradient = self.normal_equations(model, x, self.slopes(model, x, error, which), which)
            free = ~(((x <= low) & (gradient > 0.0)) | ((x >= high) & (gradient < 0.0)))
            steps = np.zeros((len(_DAMPINGS), x.size))
            inner = hessian[np.ix_(free, free)]
            for row, damping in enumerate(_DAMPINGS):
                damped = inner + damping * np.diag(np.maximum(np.diag(inner), 1e-12))
                steps[row, free] = np.linalg.lstsq(damped, -gradient[free], rcond=1e-12)[0]
            longest = _LONGEST_STEP * _sizes(model)
            trials = np.clip(x + np.clip(steps, -longest, longest), low, high)
            found = self._objectives(model, trials, error, which)
            best = int(np.argmin(found))
            gain = objective - found[best]
            if gain > 0.0:
                x, objective = trials[best], found[best]
            if gain < _PATIENCE_NATS:
                break
        return x

    def _objectives(self, model: Model, x: FloatArray, error: float, which: Which) -> FloatArray:
        centre, spread = model.priors()
        prior = 0.5 * (((x - centre) / spread) ** 2).sum(axis=1)
        return np.asarray(self._costs(model, x, error, which) + prior)

    def _costs(self, model: Model, x: FloatArray, error: float, which: Which) -> FloatArray:
        total = np.zeros(len(x))
        for n, side in enumerate(self.sides):
            z = (side.measured(which) - self.run(model, x, n, which)) / error
            soft = SOFT**2 * (np.sqrt(1.0 + (z / SOFT) ** 2) - 1.0)
            total += side.weight(which) * (soft + math.log(error)).sum(axis=1)
        return total

    def _error(self, model: Model, x: FloatArray, which: Which) -> float:
        """The likeliest error of simulated readings, SI; outliers count less."""
        parts = [
            (side.measured(which) - self.run(model, x[None], n, which)[0], side.weight(which))
            for n, side in enumerate(self.sides)
        ]
        square = np.concatenate([part for part, _ in parts]) ** 2
        weight = np.concatenate([np.full(part.size, w) for part, w in parts])
        least = self.as_read**2
        found = max(float(np.median(square)), least)
        for _ in range(_ERROR_ROUNDS):
            scaled = square / found
            mean = float(np.average(scaled / np.sqrt(1.0 + scaled / SOFT**2), weights=weight))
            found = max(found * mean, least)
        return math.sqrt(found)


def _own_predictions(
    simulator: Simulator, values: FloatArray, active: BoolArray, side: Side, wanted: Sequence[BoolArray]
) -> list[FloatArray]:
    """What each set predicts from its own states, by job at the samples that are `wanted`, a few sets at a time."""
    found = [np.empty((len(values), int(mask.sum()))) for mask in wanted]
    for part in batches(len(values), samples_of(side.jobs)):
        jobs = side.with_states(simulator, values[part], active[part])
        results = simulator.run_own(values[part], active[part], jobs)
        for own, result, mask in zip(found, results, wanted, strict=True):
            own[part] = result.predicted[:, mask]
    return found


def design_of(model: Model, slope: FloatArray, *, after: bool) -> FloatArray:
    """A side's slopes for all numbers of a model, shape (size, readings): a difference moves like what it is of."""
    count, differs = len(model.shared), len(model.differs)
    design = np.zeros((model.size, slope.shape[1]))
    design[:count] = slope[:count]
    if after:
        for place, n in enumerate(model.differs, start=count):
            design[place] = model.ways[n].of(slope)
        design[count + differs :] = slope[count:]
    return design


def _remembering(model: Model) -> IntArray:
    """The places of the logarithms and shares that are parameters of an effect with states of its own."""
    after = model.size - len(model.added)
    placed = [*enumerate(model.shared), *enumerate(model.added, start=after)]
    effects = {effect.id for effect in model.after.effects if effect.states}
    moved = [(place, each) for place, each in placed if each.positive or each.shared_out]
    own = [place for place, each in moved if each.slots[0].owner in effects]
    return np.array(own, dtype=np.int64)


def _sizes(model: Model) -> FloatArray:
    """An ordinary size of each number."""
    own = [1.0 if v.positive else max(v.scale, 1e-12) for v in [*model.shared, *model.added]]
    count = len(model.shared)
    return np.array([*own[:count], *(model.ways[n].size for n in model.differs), *own[count:]])


def _steps(model: Model, x: FloatArray) -> FloatArray:
    """Steps for differences, away from upper bounds."""
    _, high = model.bounds()
    step = (_WIDE_DIFFERENCE if model.remembers else _DIFFERENCE) * _sizes(model)
    return np.where(x + step > high, -step, step)


def window_rms(side: Side, predicted: FloatArray) -> float:
    """The mean of the RMS errors of the windows that check, SI.

    One window in which the motor sticks otherwise does not outweigh all others.

    Args:
        side: what was measured.
        predicted: of its readings that check, end to end.
    """
    return float(np.mean(each_window_rms(side, predicted)))


def each_window_rms(side: Side, predicted: FloatArray, which: Which = "check") -> FloatArray:
    """The RMS error of each window of one use, SI, shape (windows,), by what is predicted of its readings."""
    square = (side.measured(which) - predicted) ** 2
    windows = side.windows(which)
    count = np.bincount(windows)
    total = np.bincount(windows, square)
    return np.asarray(np.sqrt(total[count > 0] / count[count > 0]))
