"""Fit motors and body to the wheels' angles in simulated windows whose starts are free."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.robot.fit import widest
from nxt_twin.diagnose.robot.powered_runs import PoweredStack
from nxt_twin.physics.robot.dynamics import NAMES
from nxt_twin.physics.robot.slopes import STARTS

LENGTH_S: Final = 3.0
"""Of simulated windows, whose starts are free."""
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
"""By how much motors, body and effects differ from the given ones, ordinarily: standard deviations of a prior."""
_SOFT: Final = 2.0  # standard deviations at which the loss turns from squares to straight lines
_MOST_STEPS: Final = 10  # of Levenberg and Marquardt, at most
_MEASURED_STEPS: Final = 5
"""After so many steps, residuals are measured by what they then were."""
_DAMPINGS: Final = (0.0, 1e-3, 0.01, 0.1, 1.0, 10.0)
"""Of a step, by the curvature along each parameter: tyres that scrub make the cost rough."""
SETTLED_NATS: Final = 0.02
"""A fit ends where a step may gain no more."""
_LEAST_RAD: Final = 2e-3  # least standard deviation by which angles are measured
_MAD: Final = 1.4826  # standard deviation of normal values over their median absolute deviation
_FOUR_OF_FIVE: Final = 0.8  # share of the residuals that stay below the size that is told of them
_NOISE_S: Final = 0.5  # length of the windows whose residuals count as noise
_ALIKE: Final = 4.0
"""Neighbouring residuals of a simulated window err alike: so many count as one beside the prior."""


@final
@dataclass(frozen=True)
class Ruler:
    """By what residuals are measured.

    Attributes:
        scale_rad: their robust standard deviation.
        alike: how many neighbours count as one, since they err alike.
    """

    scale_rad: float
    alike: float


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
        left_deg: of the residuals, the size that four of five stay below.
        ruler: by which residuals were measured at the end.
    """

    values: FloatArray
    off: FloatArray
    free: BoolArray
    covariance: FloatArray
    clusters: int
    left_deg: float
    ruler: Ruler


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
    problem = _Problem(stack, given, free, stack.windows(LENGTH_S))
    at = problem.at(np.zeros(len(NAMES)) if start is None else np.where(free, start, 0.0))
    ruler, damped = problem.ruler(at), 0
    for step in range(_MOST_STEPS):
        found = problem.lower(at, ruler, max(damped - 1, 0))
        if found is None:
            break
        at, damped = found
        if step < _MEASURED_STEPS:
            ruler = problem.ruler(at)
    curvature, _ = problem.quadratic(at, ruler)
    inverse: FloatArray = np.asarray(np.linalg.inv(curvature), dtype=np.float64)
    rows, left, weight = _weighed(at, ruler)
    scores = (rows * (weight * left)[:, None]).T.reshape(len(rows.T), -1, 2).sum(axis=2)
    inner, clusters = widest(scores, (problem.window, stack.run), inverse)
    whole = np.zeros((len(NAMES), len(NAMES)))
    whole[np.ix_(free, free)] = inner + inverse @ np.diag(1.0 / _PRIOR[free] ** 2) @ inverse
    left_deg = float(np.degrees(np.quantile(np.abs(at.errors), _FOUR_OF_FIVE)))
    return PoweredFit(values_at(given, at.off), at.off, free, whole, clusters, left_deg, ruler)


def cost_of(stack: PoweredStack, fitted: PoweredFit, ruler: Ruler) -> float:
    """The cost of a fit in nats, its prior included, where residuals are measured by another's ruler."""
    return _cost(fitted.off, fitted.free, _left(stack, fitted.values, stack.windows(LENGTH_S)), ruler)


@final
@dataclass(frozen=True)
class _Point:
    """Departures from the given values, with residuals and slopes there, free starts taken out.

    Attributes:
        off: the departures, shape (26,).
        errors: shape (rows, 2), rad.
        slopes: of the free parameters, shape (rows, 2, free).
    """

    off: FloatArray
    errors: FloatArray
    slopes: FloatArray


@final
@dataclass(frozen=True)
class _Problem:
    """What is fitted to what."""

    stack: PoweredStack
    given: FloatArray
    free: BoolArray
    window: IntArray

    @property
    def least(self) -> FloatArray:
        """The least departure of each parameter from its given value, shape (26,)."""
        least = np.full(len(NAMES), -np.inf)
        least[_NEVER_NEGATIVE] = -self.given[_NEVER_NEGATIVE]
        return least

    def at(self, off: FloatArray) -> _Point:
        """Residuals and slopes of the free parameters, nothing below what it can be."""
        off = np.maximum(off, self.least)
        return _Point(off, *_projected(self.stack, self.given, off, self.free, self.window))

    def ruler(self, at: _Point) -> Ruler:
        """By what the residuals here are measured."""
        scale_rad = max(_MAD * float(np.median(np.abs(at.errors))), _LEAST_RAD)
        return Ruler(scale_rad, _ALIKE)

    def quadratic(self, at: _Point, ruler: Ruler) -> tuple[FloatArray, FloatArray]:
        """Curvature of the cost, and its slope downhill, in the free parameters."""
        rows, left, weight = _weighed(at, ruler)
        prior = 1.0 / _PRIOR[self.free] ** 2
        weighted = rows * weight[:, None]
        return weighted.T @ rows + np.diag(prior), -weighted.T @ left - prior * at.off[self.free]

    def lower(self, at: _Point, ruler: Ruler, easier: int) -> tuple[_Point, int] | None:
        """Where the least damped step leads that lowers the cost (Levenberg and Marquardt), and how it was damped.

        None where no step does, or where it may gain no more than `SETTLED_NATS`. What is zero, never negative and
        pushed below zero stays out of the step. `easier` is the first of `_DAMPINGS` to try.
        """
        curvature, downhill = self.quadratic(at, ruler)
        prior = _PRIOR[self.free]
        moves = (at.off[self.free] > self.least[self.free]) | (downhill > 0.0)
        curvature, downhill = curvature[np.ix_(moves, moves)], downhill[moves]
        if 0.5 * float(downhill @ np.linalg.solve(curvature, downhill)) < SETTLED_NATS:
            return None
        now = _cost(at.off, self.free, at.errors, ruler)
        for level in range(easier, len(_DAMPINGS)):
            damped = curvature + _DAMPINGS[level] * np.diag(np.diag(curvature))
            change = np.zeros(moves.size)
            change[moves] = np.linalg.solve(damped, downhill)
            off = at.off.copy()
            off[self.free] += change / max(1.0, float(np.max(np.abs(change) / (0.5 * prior))))
            found = self.at(off)
            if _cost(found.off, self.free, found.errors, ruler) < now:
                return found, level
        return None


def _cost(off: FloatArray, free: BoolArray, errors: FloatArray, ruler: Ruler) -> float:
    loss = float(np.sum(np.sqrt(1.0 + np.square(errors / (_SOFT * ruler.scale_rad))) - 1.0))
    prior = float(np.sum(np.square(off / _PRIOR)[free]))
    return _SOFT**2 * loss / ruler.alike + 0.5 * prior


def values_at(given: FloatArray, off: FloatArray) -> FloatArray:
    """Given values moved by `off`."""
    moved = given.copy()
    moved[:_RELATIVE] = given[:_RELATIVE] * np.exp(off[:_RELATIVE])
    moved[_RELATIVE:] = given[_RELATIVE:] + off[_RELATIVE:]
    moved[_NEVER_NEGATIVE] = np.maximum(moved[_NEVER_NEGATIVE], 0.0)
    return moved


def rms_of(stack: PoweredStack, values: FloatArray) -> float:
    """RMS of what is off in windows with free starts, degrees of the wheels."""
    return float(np.degrees(np.sqrt(np.mean(_left(stack, values, stack.windows(LENGTH_S)) ** 2))))


def noise_deg(stack: PoweredStack, values: FloatArray) -> float:
    """What half a second leaves with free starts: the counts' own noise, the size that four of five stay below."""
    left = _left(stack, values, stack.windows(_NOISE_S))
    return float(np.degrees(np.quantile(np.abs(left), _FOUR_OF_FIVE)))


def _left(stack: PoweredStack, values: FloatArray, window: IntArray) -> FloatArray:
    """What is off with free starts, rad, shape (rows, 2)."""
    off, by_starts = stack.free_starts(values, window)
    return _without_starts(off[:, :, None], by_starts, window)[:, :, 0]


def _projected(
    stack: PoweredStack, given: FloatArray, off: FloatArray, free: BoolArray, window: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Residuals and slopes of the free parameters, with what free starts account for taken out."""
    values = values_at(given, off)
    left, slopes = stack.free_starts(values, window, by_values=True)
    by_off = np.where(np.arange(off.size) < _RELATIVE, values, 1.0)
    columns = np.concatenate([left[:, :, None], slopes[:, :, STARTS:][:, :, free] * by_off[free]], axis=2)
    freed = _without_starts(columns, slopes[:, :, :STARTS], window)
    return freed[:, :, 0], freed[:, :, 1:]


def _without_starts(columns: FloatArray, by_starts: FloatArray, window: IntArray) -> FloatArray:
    """Columns of shape (rows, 2, count) less their best account by each window's start angles and speeds."""
    found = np.empty_like(columns)
    edges = np.flatnonzero(np.diff(window, prepend=-1, append=-1))
    for begin, end in itertools.pairwise(edges):
        starts = np.zeros((end - begin, 2, 4))
        starts[:, 0, 0] = starts[:, 1, 1] = 1.0
        starts[:, :, 2:] = by_starts[begin:end]
        basis, _ = np.linalg.qr(starts.reshape(-1, 4))
        flat = columns[begin:end].reshape(len(basis), -1)
        found[begin:end] = (flat - basis @ (basis.T @ flat)).reshape(columns[begin:end].shape)
    return found


def _weighed(at: _Point, ruler: Ruler) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Slopes (readings, free) and residuals in standard deviations, and weights of the soft loss."""
    rows = at.slopes.reshape(-1, at.slopes.shape[2]) / ruler.scale_rad
    left = at.errors.ravel() / ruler.scale_rad
    return rows, left, 1.0 / np.sqrt(1.0 + (left / _SOFT) ** 2) / ruler.alike
