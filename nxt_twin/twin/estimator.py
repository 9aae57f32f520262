"""The one seam to filterpy: an extended Kalman filter whose motion comes from outside, and its multiple models.

What filterpy gives is wrapped in plain arrays here; nothing else of the tool knows that library.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, final

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter, IMMEstimator, KalmanFilter

from nxt_twin.arrays import FloatArray

_LOG_TAU = math.log(2.0 * math.pi)
_LEAST_LIKELIHOOD = 1e-30
_MIX_EVERY_S = 0.25


class ComparedReading(NamedTuple):
    """A reading beside its prediction: what was predicted, the variance of the difference, and its log-density."""

    predicted: float
    variance: float
    normalised_square: float
    log_likelihood: float


def _first_of(state: FloatArray) -> FloatArray:
    """What is read."""
    return state[:1]


@final
class Estimator:
    """A Gaussian estimate of a few numbers, of which the first is read.

    Args:
        mean: to begin with, shape (n,).
        variances: of its components, which begin independent, shape (n,).
    """

    def __init__(self, mean: FloatArray, variances: FloatArray) -> None:
        size = mean.size
        self._filter = ExtendedKalmanFilter(dim_x=size, dim_z=1)
        self._first = np.eye(1, size)
        self.set(mean, np.diag(variances))

    def _slope(self, _: FloatArray) -> FloatArray:
        """How what is read depends on the state."""
        return self._first

    @property
    def mean(self) -> FloatArray:
        """The estimate, shape (n,)."""
        found: FloatArray = self._filter.x[:, 0]
        return found

    @property
    def covariance(self) -> FloatArray:
        """Its covariance, shape (n, n)."""
        found: FloatArray = self._filter.P
        return found

    def set(self, mean: FloatArray, covariance: FloatArray) -> None:
        """Replace the estimate."""
        self._filter.x = np.array(mean, dtype=np.float64).reshape(-1, 1)
        self._filter.P = np.array(covariance, dtype=np.float64)

    def predict(self, moved: FloatArray, transition: FloatArray, process: FloatArray) -> None:
        """Let time pass.

        Args:
            moved: where the mean has got to, shape (n,).
            transition: how it depends on where it was, shape (n, n).
            process: covariance of what came in addition, shape (n, n).
        """
        self._filter.F, self._filter.Q = transition, process
        self._filter.predict()
        self._filter.x = moved.reshape(-1, 1).copy()

    def compare(self, reading: float, variance: float) -> ComparedReading:
        """The innovation of a reading of the first component; the state stays as it is."""
        predicted = float(self._filter.x[0, 0])
        total = float(self._filter.P[0, 0]) + variance
        square = (reading - predicted) ** 2 / total
        return ComparedReading(predicted, total, square, -0.5 * (square + math.log(total) + _LOG_TAU))

    def update(self, reading: float, variance: float) -> ComparedReading:
        """Believe a reading of the first component."""
        compared = self.compare(reading, variance)
        self._filter.update(
            np.array([[reading]]), HJacobian=self._slope, Hx=_first_of, R=np.array([[variance]])
        )
        return compared


@final
class _Model:
    """An estimator as filterpy's multiple models want it: only what all have in common mixes.

    They ask for it often, so it is taken out of the estimator before, and given back after.
    """

    def __init__(self, estimator: Estimator, shared: int) -> None:
        self._estimator = estimator
        self._shared = shared
        self.likelihood = 1.0
        self.take()

    def take(self) -> None:
        """Have what the estimator has."""
        shared = self._shared
        self.x = self._estimator.mean[:shared].reshape(-1, 1).copy()
        self.P = self._estimator.covariance[:shared, :shared].copy()

    def give(self) -> None:
        """Give back what was mixed.

        The rest keeps its variance; what it had to do with the shared part is scaled, so that all stays whole.
        """
        mean, whole = self._estimator.mean.copy(), self._estimator.covariance.copy()
        shared = self._shared
        before = np.maximum(np.diag(whole)[:shared], 1e-18)
        scale = np.sqrt(np.minimum(np.diag(self.P) / before, 1.0))
        mean[:shared] = self.x[:, 0]
        whole[:shared, :shared] = self.P
        whole[:shared, shared:] *= scale[:, None]
        whole[shared:, :shared] = whole[:shared, shared:].T
        self._estimator.set(mean, whole)

    def predict(self, _: object) -> None:
        """Time passes elsewhere."""

    def update(self, z: Mapping[int, float]) -> None:
        self.likelihood = z[id(self)]


@final
class Weigher:
    """Interacting multiple models: how probable each of several estimators is right now.

    Args:
        estimators: by name; the first `shared` components mean the same in all of them.
        shared: how many.
        prior: their probabilities to begin with.
        memory_s: how long one of them goes on being the right one.
    """

    def __init__(
        self, estimators: Mapping[str, Estimator], shared: int, prior: Sequence[float], memory_s: float
    ) -> None:
        self._names = tuple(estimators)
        self._models = [_Model(estimator, shared) for estimator in estimators.values()]
        self._memory_s = memory_s
        self._prior = np.array(prior, dtype=np.float64)
        self._since_s = 0.0
        self._logs = np.zeros(len(self._models))
        self._imm: Any = IMMEstimator(self._models, self._prior, self._stay(0.0))

    @property
    def probabilities(self) -> dict[str, float]:
        """By name; they sum to 1."""
        return dict(zip(self._names, map(float, self._imm.mu), strict=True))

    def update(self, log_likelihoods: Sequence[float], since_s: float) -> None:
        """Take what one reading, `since_s` after the last, says for each.

        Several readings are taken together before the estimators mix.
        """
        self._since_s += since_s
        self._logs += log_likelihoods
        if self._since_s < _MIX_EVERY_S:
            return
        relative = np.exp(np.maximum(self._logs - self._logs.max(), math.log(_LEAST_LIKELIHOOD)))
        for model in self._models:
            model.take()
        self._imm.M = self._stay(self._since_s)
        self._imm.update({id(model): float(r) for model, r in zip(self._models, relative, strict=True)})
        self._imm.predict()
        for model in self._models:
            model.give()
        self._since_s = 0.0
        self._logs[:] = 0.0

    def _stay(self, since_s: float) -> FloatArray:
        leave = 1.0 - math.exp(-since_s / self._memory_s)
        share = self._prior / self._prior.sum()
        stay: FloatArray = (1.0 - leave) * np.eye(share.size) + leave * share[None, :]
        return stay


@final
class Drift:
    """A number that wanders at a wandering rate, for readings without a model behind them.

    Args:
        value: to begin with.
        variance: of it.
        jerk: how much the rate changes, unit² per s³ (spectral density).
        rate_std: of the rate to begin with, unit per s.
    """

    def __init__(self, value: float, variance: float, jerk: float, rate_std: float) -> None:
        self._filter = KalmanFilter(dim_x=2, dim_z=1)
        self._filter.x = np.array([[value], [0.0]])
        self._filter.P = np.diag([variance, rate_std**2])
        self._filter.H = np.array([[1.0, 0.0]])
        self._jerk = jerk

    @property
    def value(self) -> float:
        """The estimate."""
        return float(self._filter.x[0, 0])

    def predict(self, dt_s: float) -> None:
        """Let time pass."""
        powers = np.array([[dt_s**3 / 3.0, dt_s**2 / 2.0], [dt_s**2 / 2.0, dt_s]])
        self._filter.predict(F=np.array([[1.0, dt_s], [0.0, 1.0]]), Q=self._jerk * powers)

    def compare(self, reading: float, variance: float) -> ComparedReading:
        """The innovation of a reading; the state stays as it is."""
        predicted = self.value
        total = float(self._filter.P[0, 0]) + variance
        square = (reading - predicted) ** 2 / total
        return ComparedReading(predicted, total, square, -0.5 * (square + math.log(total) + _LOG_TAU))

    def update(self, reading: float, variance: float) -> None:
        """Believe a reading."""
        self._filter.update(np.array([[reading]]), R=np.array([[variance]]))
