"""Fit motors and body to the wheels' angles in simulated windows whose starts are free."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.robot.fit import widest
from nxt_twin.diagnose.robot.powered_runs import PoweredStack
from nxt_twin.physics.robot.dynamics import NAMES

LENGTHS_S: Final = (3.0,)
_RELATIVE: Final = 12
"""The first so many parameters are positive and move by factors."""

_NEVER_NEGATIVE: Final = [NAMES.index(name) for name in ("scrub_torque", "battery_resistance")]
_SCRUB_NM: Final = 4e-3
"""By how much the torque of tyres against turning is off, ordinarily: as of 4 N on tyres that scrub at 1 mm."""
_PRIOR: Final = np.array(
    [
        *(0.15, 0.15, 0.12, 0.12, 0.5, 0.5, 0.6, 0.6, 0.2, 0.2, 0.03, 0.05),
        *(2.0, 0.3, 0.3, 0.1, 0.1, 2.0, _SCRUB_NM, 2.0, 0.01, 0.01, 1e-3, 1e-3, 1.0, 1.0),
    ]
)
_STEPS: Final = np.array(
    [
        *[1e-4] * _RELATIVE,
        *(1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-3, 1e-5, 1e-3, 1e-5, 1e-5, 1e-6, 1e-6, 1e-3, 1e-3),
    ]
)
_SOFT: Final = 2.0
_MOST_STEPS: Final = 10
_SCALED_STEPS: Final = 5
"""After so many steps, residuals are measured by what they then were."""
_DAMPINGS: Final = (0.0, 1e-3, 0.01, 0.1, 1.0, 10.0)
"""Of a step, by the curvature along each parameter: tyres that scrub make the cost rough."""
_LEAST_RAD: Final = 2e-3
_MAD: Final = 1.4826
_SMALL: Final = 0.3
_FOUR_OF_FIVE: Final = 0.8
_NOISE_S: Final = 0.5
_ALIKE: Final = 4.0
"""Neighbouring residuals of a simulated window err alike: so many count as one beside the prior."""


@final
@dataclass(frozen=True)
class PoweredFit:
    """A fit of motors and body.

    Attributes:
        values: in the order of `dynamics.NAMES`.
        off: departure from the given values, relative for the first twelve.
        free: which were fitted.
        covariance: of `off`.
        clusters: how many independent parts it rests on.
        left_deg: of the residuals in windows of the first length, the size that four of five stay below.
        scales: by which residuals were measured at the end, rad, one for each length of windows.
    """

    values: FloatArray
    off: FloatArray
    free: BoolArray
    covariance: FloatArray
    clusters: int
    left_deg: float
    scales: tuple[float, ...]


def fit_powered(
    stack: PoweredStack, given: FloatArray, free: BoolArray, start: FloatArray | None = None
) -> PoweredFit:
    """Fit the free parameters, from the given values and with a prior round them.

    Args:
        stack: the runs.
        given: values in the order of `dynamics.NAMES`.
        free: which to fit, shape (26,).
        start: departures from the given values to begin at; None for none.
    """
    windows = [stack.windows(length) for length in LENGTHS_S]
    off = np.zeros(len(NAMES)) if start is None else np.where(free, start, 0.0)
    prior = np.diag(1.0 / _PRIOR[free] ** 2)
    slopes, errors = _projected(stack, given, off, free, windows)
    scales = _scales(errors)
    for step in range(_MOST_STEPS):
        rows, left, weight = _weighed(slopes, errors, scales)
        curvature = (rows * weight[:, None]).T @ rows + prior
        downhill = -(rows * weight[:, None]).T @ left - prior @ off[free]
        found = _Tried(stack, given, off, free, windows, scales).lower(downhill, curvature, errors)
        if found is None:
            break
        change, off = (found - off)[free], found
        slopes, errors = _projected(stack, given, off, free, windows)
        if step < _SCALED_STEPS:
            scales = _scales(errors)
        if np.max(np.abs(change) * np.sqrt(np.diag(curvature))) < _SMALL and step >= 2:
            break
    rows, left, weight = _weighed(slopes, errors, scales)
    inverse: FloatArray = np.asarray(
        np.linalg.inv((rows * weight[:, None]).T @ rows + prior), dtype=np.float64
    )
    scores = (rows * (weight * left)[:, None]).T.reshape(len(rows.T), len(windows), -1, 2).sum(axis=(1, 3))
    inner, clusters = widest(scores, (windows[-1], stack.run), inverse)
    whole = np.zeros((len(NAMES), len(NAMES)))
    whole[np.ix_(free, free)] = inner + inverse @ prior @ inverse
    left_deg = float(np.degrees(np.quantile(np.abs(errors[0]), _FOUR_OF_FIVE)))
    return PoweredFit(values_at(given, off), off, free, whole, clusters, left_deg, tuple(scales))


def cost_of(stack: PoweredStack, given: FloatArray, fitted: PoweredFit, scales: Sequence[float]) -> float:
    """The cost of a fit in nats, its prior included, where residuals are measured by these scales."""
    windows = [stack.windows(length) for length in LENGTHS_S]
    return _Tried(stack, given, fitted.off, fitted.free, windows, list(scales)).cost()


@final
@dataclass(frozen=True)
class _Tried:
    """Where a step begins, and what its ends are judged by."""

    stack: PoweredStack
    given: FloatArray
    off: FloatArray
    free: BoolArray
    windows: list[IntArray]
    scales: list[float]

    def lower(
        self, downhill: FloatArray, curvature: FloatArray, errors: list[FloatArray]
    ) -> FloatArray | None:
        """Where the least damped step leads that lowers the cost (Levenberg and Marquardt); None where none does."""
        now, most = self._cost(self.off, errors), 0.5 * _PRIOR[self.free]
        for damping in _DAMPINGS:
            change = np.linalg.solve(curvature + damping * np.diag(np.diag(curvature)), downhill)
            off = self.off.copy()
            off[self.free] += change / max(1.0, float(np.max(np.abs(change) / most)))
            if self._cost(off, self._errors(off)) < now:
                return off
        return None

    def cost(self) -> float:
        """The cost where the step begins."""
        return self._cost(self.off, self._errors(self.off))

    def _errors(self, off: FloatArray) -> list[FloatArray]:
        found = []
        for window in self.windows:
            left, answers = self.stack.free_starts(values_at(self.given, off), window)
            found.append(_without_starts(np.array([left]), answers, window)[0])
        return found

    def _cost(self, off: FloatArray, errors: list[FloatArray]) -> float:
        scaled = [
            np.square(error / (_SOFT * scale)) for error, scale in zip(errors, self.scales, strict=True)
        ]
        loss = sum(float(np.sum(np.sqrt(1.0 + one) - 1.0)) for one in scaled)
        return _SOFT**2 * loss / (_ALIKE * len(scaled)) + 0.5 * float(
            np.sum(np.square(off / _PRIOR)[self.free])
        )


def _scales(errors: list[FloatArray]) -> list[float]:
    return [max(_MAD * float(np.median(np.abs(one))), _LEAST_RAD) for one in errors]


def values_at(given: FloatArray, off: FloatArray) -> FloatArray:
    """Given values moved by `off`."""
    moved = given.copy()
    moved[:_RELATIVE] = given[:_RELATIVE] * np.exp(off[:_RELATIVE])
    moved[_RELATIVE:] = given[_RELATIVE:] + off[_RELATIVE:]
    moved[_NEVER_NEGATIVE] = np.maximum(moved[_NEVER_NEGATIVE], 0.0)
    return moved


def rms_of(stack: PoweredStack, values: FloatArray) -> float:
    """RMS of what is off in windows of the first length with free starts, degrees of the wheels."""
    window = stack.windows(LENGTHS_S[0])
    off, answers = stack.free_starts(values, window)
    left = _without_starts(np.array([off]), answers, window)[0]
    return float(np.degrees(np.sqrt(np.mean(left**2))))


def noise_deg(stack: PoweredStack, values: FloatArray) -> float:
    """What half a second leaves with free starts: the counts' own noise, the size that four of five stay below."""
    window = stack.windows(_NOISE_S)
    off, answers = stack.free_starts(values, window)
    left = _without_starts(np.array([off]), answers, window)[0]
    return float(np.degrees(np.quantile(np.abs(left), _FOUR_OF_FIVE)))


def _projected(
    stack: PoweredStack, given: FloatArray, off: FloatArray, free: BoolArray, windows: list[IntArray]
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Slopes and residuals by length of window, with what free starts account for taken out."""
    slopes, errors = [], []
    for window in windows:
        begins = np.diff(window, prepend=-1) != 0
        left, answers = stack.free_starts(values_at(given, off), window)
        columns = [left]
        for place in np.flatnonzero(free):
            nudged = off.copy()
            nudged[place] += _STEPS[place]
            columns.append((stack.off(values_at(given, nudged), begins, stack.speeds) - left) / _STEPS[place])
        freed = _without_starts(np.array(columns), answers, window)
        errors.append(freed[0])
        slopes.append(freed[1:])
    return slopes, errors


def _without_starts(columns: FloatArray, answers: FloatArray, window: IntArray) -> FloatArray:
    """Columns of shape (count, rows, 2) less their best account by each window's start angles and speeds."""
    found = np.empty_like(columns)
    edges = np.flatnonzero(np.diff(window, prepend=-1, append=-1))
    for begin, end in itertools.pairwise(edges):
        size = 2 * (end - begin)
        starts = np.zeros((end - begin, 2, 4))
        starts[:, 0, 0] = starts[:, 1, 1] = 1.0
        starts[:, :, 2:] = np.moveaxis(answers[:, begin:end], 0, 2)
        basis, _ = np.linalg.qr(starts.reshape(size, 4))
        flat = columns[:, begin:end].reshape(len(columns), size).T
        found[:, begin:end] = (flat - basis @ (basis.T @ flat)).T.reshape(len(columns), end - begin, 2)
    return found


def _weighed(
    slopes: list[FloatArray], errors: list[FloatArray], scales: list[float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """All lengths together: slopes (readings, free), residuals, and weights of the soft loss."""
    rows = np.concatenate(
        [slope.reshape(len(slope), -1) / scale for slope, scale in zip(slopes, scales, strict=True)], axis=1
    )
    left = np.concatenate([error.ravel() / scale for error, scale in zip(errors, scales, strict=True)])
    weight = 1.0 / np.sqrt(1.0 + (left / _SOFT) ** 2) / (_ALIKE * len(scales))
    return rows.T, left, weight
