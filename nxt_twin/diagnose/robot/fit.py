"""Fit a geometry and the runs' clocks to windows: soft loss, Gauss and Newton's steps, sandwich covariance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.robot.stack import PoseWindows, RunStack
from nxt_twin.diagnose.robot.windows import PARAMETERS, DriveState, lengths_for, residuals, scales_of

_STEPS: Final = np.array([1e-6, 1e-5, 1e-5, 1e-5, 1e-5, 1e-3])
_PRIOR: Final = np.array([0.1, 0.05, 0.15, 0.05, 0.05, 10.0])
"""Standard deviations of a weak prior round the given values: radius and track relative, others as they are."""

_LAG_STEP_S: Final = 1e-3  # of a difference quotient by a lag, s
_RATE_STEP: Final = 1e-4  # of a difference quotient by a lag's growth, s/s
_LAG_PRIOR: Final = np.array([0.2, 0.02])
_SOFT: Final = 2.0  # standard deviations at which the loss turns from squares to straight lines
_MOST_STEPS: Final = 12  # of Gauss and Newton, at most
_SMALL: Final = 0.2  # of a parameter's own standard deviation
_RESCALED: Final = 3  # first steps, which measure the residuals' scales anew; no fit ends in them


@final
@dataclass(frozen=True)
class FittedGeometry:
    """A fit of some of the parameters.

    Attributes:
        state: the fitted values.
        free: which of `PARAMETERS` were fitted, shape (6,).
        clock: whether each run's lag and its rate were.
        scales: of the residuals, shape (lengths, 3, 1).
        errors: the residuals themselves, shape (lengths, 3, rows).
        covariance: of the geometry, shape (6, 6), zero where not fitted.
        clusters: how many independent parts it rests on.
        lag_std: of each run's lag (s) and rate, shape (runs, 2); zero where not fitted.
        lag_nats: what each run's own clock gains, shape (runs,).
    """

    state: DriveState
    free: BoolArray
    clock: bool
    scales: FloatArray
    errors: FloatArray
    covariance: FloatArray
    clusters: int
    lag_std: FloatArray
    lag_nats: FloatArray


def fit_windows(
    stack: RunStack, start: DriveState, free: BoolArray, *, clock: bool, scales: FloatArray | None = None
) -> FittedGeometry:
    """Fit the free parameters from `start`, which also is the centre of the prior.

    Args:
        stack: the runs.
        start: the values given; what is not free stays there.
        free: which of `PARAMETERS` to fit, shape (6,).
        clock: fit each run's lag and its rate too.
        scales: of the residuals, as another fit found them; None to find them.
    """
    parts = tuple(stack.windows(length) for length in lengths_for(stack))
    state, given = start, scales
    for step in range(_MOST_STEPS):
        errors = residuals(stack, parts, state)
        if given is None and step < _RESCALED:
            scales = scales_of(errors)
        assert scales is not None  # noqa: S101  # found in the first step where not given
        slopes = _Slopes(stack, parts, state, errors, scales, free, clock=clock)
        state, moved = slopes.step(state, start, free)
        if moved < _SMALL and step >= _RESCALED:
            break
    errors = residuals(stack, parts, state)
    assert scales is not None  # noqa: S101
    slopes = _Slopes(stack, parts, state, errors, scales, free, clock=clock)
    covariance, clusters = slopes.covariance(free, _clusters(stack, parts[-1]), start)
    lag_std, lag_nats = slopes.clock_doubt(state, parts[0])
    return FittedGeometry(state, free, clock, scales, errors, covariance, clusters, lag_std, lag_nats)


def _clusters(stack: RunStack, longest: PoseWindows) -> tuple[IntArray, ...]:
    """Parts of the rows that may err together: longest windows, recordings, sessions."""
    sessions = [run.session for run in stack.runs]
    number = {name: index for index, name in enumerate(dict.fromkeys(sessions))}
    of_run = np.array([number[name] for name in sessions])
    return longest.of_row, stack.run, of_run[stack.run]


@final
class _Slopes:
    """Residuals and their slopes at one state, with the weights of the soft loss."""

    def __init__(
        self,
        stack: RunStack,
        parts: tuple[PoseWindows, ...],
        state: DriveState,
        errors: FloatArray,
        scales: FloatArray,
        free: BoolArray,
        *,
        clock: bool,
    ) -> None:
        scaled = errors / scales
        self._scaled = scaled
        self._weight = 1.0 / np.sqrt(1.0 + (scaled / _SOFT) ** 2)
        self._stack = stack
        self._geometry = np.zeros((len(PARAMETERS), *errors.shape))
        for index in np.flatnonzero(free):
            self._geometry[index] = _slope(stack, parts, state, errors, int(index)) / scales
        self._clock = np.zeros((0, *errors.shape))
        if clock:
            late = DriveState(state.geometry, state.lag_s + _LAG_STEP_S, state.rate)
            faster = DriveState(state.geometry, state.lag_s, state.rate + _RATE_STEP)
            changed = [
                (residuals(stack, parts, late) - errors) / _LAG_STEP_S,
                (residuals(stack, parts, faster) - errors) / _RATE_STEP,
            ]
            self._clock = np.array(changed) / scales

    def step(self, state: DriveState, start: DriveState, free: BoolArray) -> tuple[DriveState, float]:
        """The next state, and the largest move in standard deviations."""
        prior = _prior(start)
        curvature, slope = self._normal(self._geometry[free], self._geometry[free])
        curvature += np.diag(1.0 / prior[free] ** 2)
        slope = slope + (state.geometry - start.geometry)[free] / prior[free] ** 2
        if not self._clock.size:
            change = -np.linalg.solve(curvature, slope)
            lag_change = np.zeros((len(self._stack.runs), 2))
        else:
            change, lag_change = self._bordered(curvature, slope, state, free)
        geometry = state.geometry.copy()
        geometry[free] += change
        moved = float(np.max(np.abs(change) * np.sqrt(np.diag(curvature)), initial=0.0))
        new = DriveState(geometry, state.lag_s + lag_change[:, 0], state.rate + lag_change[:, 1])
        return new, moved

    def _bordered(
        self, curvature: FloatArray, slope: FloatArray, state: DriveState, free: BoolArray
    ) -> tuple[FloatArray, FloatArray]:
        """One step of the geometry and of each run's clock together."""
        own, mixed, own_slope = self._by_run(free, state)
        solved = np.linalg.solve(own, np.concatenate([mixed, own_slope[..., None]], axis=2))
        reduced = curvature - np.einsum("rkp,rkq->pq", mixed, solved[..., :-1])
        lowered = slope - np.einsum("rkp,rk->p", mixed, solved[..., -1])
        change = -np.linalg.solve(reduced, lowered)
        return change, -(solved[..., -1] + solved[..., :-1] @ change)

    def _by_run(self, free: BoolArray, state: DriveState) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of each run: curvature of its clock (2, 2), mixed with the geometry (2, free), and slope (2,)."""
        columns = np.concatenate([self._clock, self._geometry[free], self._scaled[None]])
        starts = np.flatnonzero(np.diff(self._stack.run, prepend=-1))
        table = np.array(
            [
                [
                    np.add.reduceat(np.sum(one * other * self._weight, axis=(0, 1)), starts)
                    for other in columns
                ]
                for one in self._clock
            ]
        )
        table = np.moveaxis(table, 2, 0)
        own = table[:, :, :2] + np.diag(1.0 / _LAG_PRIOR**2)
        lags = np.stack([state.lag_s, state.rate], axis=1) / _LAG_PRIOR**2
        return own, table[:, :, 2:-1], table[:, :, -1] + lags

    def _normal(self, one: FloatArray, other: FloatArray) -> tuple[FloatArray, FloatArray]:
        count = self._scaled.size
        weighted = (one * self._weight).reshape(len(one), count)
        return weighted @ other.reshape(len(other), count).T, weighted @ self._scaled.ravel()

    def covariance(
        self, free: BoolArray, clusters: tuple[IntArray, ...], start: DriveState
    ) -> tuple[FloatArray, int]:
        """Sandwich covariance of the geometry, the widest that the kinds of clusters give, and their number."""
        if not free.any():
            return np.zeros((free.size, free.size)), int(np.unique(clusters[0]).size)
        columns = self._geometry[free]
        if self._clock.size:
            own, mixed, _ = self._by_run(
                free, DriveState(start.geometry, 0.0 * start.lag_s, 0.0 * start.rate)
            )
            freed = np.linalg.solve(own, mixed)  # (runs, 2, free)
            columns = columns - np.einsum("klcn,nkp->plcn", self._clock, freed[self._stack.run])
        curvature, _ = self._normal(columns, columns)
        inverse: FloatArray = np.asarray(
            np.linalg.inv(curvature + np.diag(1.0 / _prior(start)[free] ** 2)), dtype=np.float64
        )
        scores = np.sum(columns * (self._weight * self._scaled), axis=(1, 2))  # (free, rows)
        inner, number = widest(scores, clusters, inverse)
        # What the recordings leave open is as doubtful as the prior.
        inner = inner + inverse @ np.diag(1.0 / _prior(start)[free] ** 2) @ inverse
        whole = np.zeros((free.size, free.size))
        whole[np.ix_(free, free)] = inner
        return whole, number

    def clock_doubt(self, state: DriveState, short: PoseWindows) -> tuple[FloatArray, FloatArray]:
        """Standard deviations of each run's lag and rate, and what they gain together, nats."""
        runs = len(self._stack.runs)
        stds, nats = np.zeros((runs, 2)), np.zeros(runs)
        if not self._clock.size:
            return stds, nats
        scores = np.sum(self._clock * (self._weight * self._scaled), axis=(1, 2))
        own, _, _ = self._by_run(np.zeros(len(PARAMETERS), dtype=bool), state)
        for index in range(runs):
            rows = self._stack.run == index
            inverse = np.linalg.inv(own[index])
            doubt, number = sandwich(scores[:, rows], short.of_row[rows], inverse)
            doubt += inverse  # no surer than independent residuals would be
            stds[index] = np.sqrt(np.diag(doubt))
            found = np.array([state.lag_s[index], state.rate[index]])
            nats[index] = robust_nats(float(found @ np.linalg.solve(doubt, found)), max(number, 3))
        return stds, nats


def robust_nats(squared: float, clusters: int) -> float:
    """The log-likelihood (nats) of a squared distance in standard deviations, estimated from `clusters` clusters."""
    return 0.5 * clusters * float(np.log1p(squared / max(clusters - 1, 1)))


def sandwich(scores: FloatArray, cluster: IntArray, inverse: FloatArray) -> tuple[FloatArray, int]:
    """Covariance from sums of scores over clusters, and the number of clusters."""
    _, place = np.unique(cluster, return_inverse=True)
    sums = np.array([np.bincount(place, weights=row) for row in scores])
    number = sums.shape[1]
    inner = sums @ sums.T * (number / max(number - 1, 1))
    return np.asarray(inverse @ inner @ inverse, dtype=np.float64), number


_WIDER: Final = 1.5
"""A coarser kind of cluster counts where its variance is so many times that of a finer one."""

_FEWEST_CLUSTERS: Final = 7  # of a coarser kind, below which their covariance is passed over


def widest(scores: FloatArray, clusters: tuple[IntArray, ...], inverse: FloatArray) -> tuple[FloatArray, int]:
    """The finest clusters' covariance, widened in each parameter to coarser ones' variance where that is larger."""
    covariance, number = sandwich(scores, clusters[0], inverse)
    covariance = covariance + 1e-6 * inverse
    for coarser in clusters[1:]:
        wide, fewer = sandwich(scores, coarser, inverse)
        if fewer < _FEWEST_CLUSTERS:
            continue
        ratio = np.diag(wide) / np.diag(covariance)
        if np.any(ratio > _WIDER):
            stretch = np.sqrt(np.where(ratio > _WIDER, ratio, 1.0))
            covariance = covariance * np.outer(stretch, stretch)
            number = fewer
    return covariance, number


def _slope(
    stack: RunStack, parts: tuple[PoseWindows, ...], state: DriveState, errors: FloatArray, index: int
) -> FloatArray:
    moved = state.geometry.copy()
    moved[index] += _STEPS[index]
    return (residuals(stack, parts, DriveState(moved, state.lag_s, state.rate)) - errors) / float(
        _STEPS[index]
    )


def _prior(start: DriveState) -> FloatArray:
    scale = _PRIOR.copy()
    scale[[0, 2]] *= start.geometry[[0, 2]]
    return scale
