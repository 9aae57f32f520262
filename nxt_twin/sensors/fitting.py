"""Maximum likelihood with standard deviations, for likelihoods that may have edges.

The curvature comes from steps at which the log-likelihood falls by about half a nat, the scale of the standard
deviation. On a smooth likelihood this is the observed Fisher information. Across a threshold between two readings it
gives about half the gap, where a derivative would give nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.errors import SensorError

ParametersT = TypeVar("ParametersT")

_WANTED_DROP = 0.5
_STEP_TRIES = 40
_CLOSEST = 0.999
_SLACK = 0.4
_SMALLEST_EIGENVALUE = 1e-9
_ROUNDS = 2
_PAYS_NATS = 0.01


@final
@dataclass(frozen=True)
class Free:
    """A parameter that is fitted.

    Attributes:
        name: the dataclass field.
        lower, upper: bounds.
        scale: a change of it that matters.
    """

    name: str
    lower: float
    upper: float
    scale: float


@final
@dataclass(frozen=True)
class FittedSensor(Generic[ParametersT]):
    """A fit.

    Attributes:
        parameters: all parameters, the fitted ones at their likeliest.
        names: the fitted ones, in the order of `covariance`.
        std: standard deviation of each fitted one.
        covariance: shape (fitted, fitted).
        log_likelihood: at the optimum, nats.
    """

    parameters: ParametersT
    names: tuple[str, ...]
    std: Mapping[str, float]
    covariance: FloatArray
    log_likelihood: float


def chosen(known: Sequence[Free], names: Sequence[str], readings: FloatArray, sensor: str) -> list[Free]:
    """The parameters of these names, if the number of readings can tell them.

    Raises:
        SensorError: a name that cannot be fitted, or no more readings than parameters.
    """
    by_name = {part.name: part for part in known}
    unknown = [name for name in names if name not in by_name]
    if unknown:
        mend = f"known are {', '.join(by_name)}"
        raise SensorError(f"cannot fit {', '.join(unknown)}", where=sensor, mend=mend)
    if int(np.count_nonzero(~np.isnan(readings))) <= len(names):
        raise SensorError("too few readings", where=sensor, mend="record more")
    return [by_name[name] for name in names]


def fit_free(
    log_likelihood: Callable[[ParametersT], float], start: ParametersT, free: Sequence[Free]
) -> FittedSensor[ParametersT]:
    """Fit the `free` parameters from `start`; all others keep their values."""

    def at(x: FloatArray) -> ParametersT:
        changes: dict[str, Any] = {part.name: float(value) for part, value in zip(free, x, strict=True)}
        return replace(start, **changes)  # type: ignore[type-var]

    def objective(x: FloatArray) -> float:
        return log_likelihood(at(x))

    x0 = np.array([getattr(start, part.name) for part in free], dtype=np.float64)
    best = maximise(objective, x0, free)
    covariance = covariance_at(objective, best, free)
    stds = np.sqrt(np.diag(covariance))
    names = tuple(part.name for part in free)
    return FittedSensor(
        at(best), names, dict(zip(names, map(float, stds), strict=True)), covariance, objective(best)
    )


def maximise(objective: Callable[[FloatArray], float], x0: FloatArray, free: Sequence[Free]) -> FloatArray:
    """The likeliest values: gradient steps, then a simplex for the edges, as long as it pays."""
    x = climb(objective, x0, free)
    for _ in range(_ROUNDS):
        before = objective(x)
        x = climb(objective, _simplex_search(objective, x, free), free)
        if objective(x) - before < _PAYS_NATS:
            break
    return x


def climb(
    objective: Callable[[FloatArray], float], x0: FloatArray, free: Sequence[Free], most_steps: int = 50
) -> FloatArray:
    """Gradient steps alone; a few are enough to compare starts."""
    lower, upper, scale = _bounds(free)
    begin = np.clip(x0, lower, upper)
    if x0.size == 0:
        return begin
    cost = _cost(objective, free)
    x, least = _minimised(cost, begin, free, method="L-BFGS-B", options={"maxiter": most_steps, "ftol": 1e-9})
    return x if least < cost(begin / scale) else begin


def _simplex_search(
    objective: Callable[[FloatArray], float], x0: FloatArray, free: Sequence[Free]
) -> FloatArray:
    lower, upper, scale = _bounds(free)
    if x0.size == 0:
        return x0
    corners = _simplex(x0 / scale, lower / scale, upper / scale)
    options = {"initial_simplex": corners, "maxfev": 60 * x0.size, "xatol": 1e-3, "fatol": 1e-3}
    return _minimised(_cost(objective, free), x0, free, method="Nelder-Mead", options=options)[0]


def _minimised(
    cost: Callable[[FloatArray], float], begin: FloatArray, free: Sequence[Free], **how: object
) -> tuple[FloatArray, float]:
    """Where `cost` (of values over their scales) is least within the bounds, and how much it is there."""
    from scipy.optimize import minimize  # slow to import, and a motor's diagnosis never comes here

    lower, upper, scale = _bounds(free)
    box = list(zip(lower / scale, upper / scale, strict=True))
    end = minimize(cost, begin / scale, bounds=box, **how)
    return np.asarray(np.clip(end.x * scale, lower, upper), dtype=np.float64), float(end.fun)


def _cost(objective: Callable[[FloatArray], float], free: Sequence[Free]) -> Callable[[FloatArray], float]:
    lower, upper, scale = _bounds(free)

    def cost(z: FloatArray) -> float:
        value = -objective(np.clip(z * scale, lower, upper))
        return value if np.isfinite(value) else 1e12

    return cost


def covariance_at(
    objective: Callable[[FloatArray], float], best: FloatArray, free: Sequence[Free]
) -> FloatArray:
    """The inverse of the curvature over steps of about half a nat; shape (free, free)."""
    count = best.size
    if count == 0:
        return np.zeros((0, 0))
    lower, upper, scale = _bounds(free)
    top = objective(best)
    steps = np.array([_step(objective, best, top, i, scale[i], lower[i], upper[i]) for i in range(count)])

    def drop(*moves: tuple[int, int]) -> float:
        x = best.copy()
        for index, sign in moves:
            x[index] += sign * steps[index]
        return top - objective(np.clip(x, lower, upper))

    bends = [drop((i, 1)) + drop((i, -1)) for i in range(count)]
    curvature = np.diag([_bend(bend) for bend in bends])
    for i in range(count):
        for j in range(i):
            mixed = (
                drop((i, 1), (j, 1)) + drop((i, -1), (j, -1)) - drop((i, 1), (j, -1)) - drop((i, -1), (j, 1))
            )
            most = _CLOSEST * np.sqrt(curvature[i, i] * curvature[j, j])
            curvature[i, j] = curvature[j, i] = np.clip(0.25 * mixed, -most, most)
    values, vectors = np.linalg.eigh(curvature)
    inverse = (vectors / np.maximum(values, _SMALLEST_EIGENVALUE)) @ vectors.T
    return np.asarray(inverse * np.outer(steps, steps), dtype=np.float64)


def _bend(both_sides: float) -> float:
    """The curvature from the two falls, half a nat each; one where walls at unlike distances make them unlike that."""
    return both_sides if 1.0 - _SLACK < both_sides < 1.0 + _SLACK else 1.0


def _step(
    objective: Callable[[FloatArray], float],
    best: FloatArray,
    top: float,
    index: int,
    scale: float,
    lower: float,
    upper: float,
) -> float:
    """How far the parameter has to move, alone, for the likelihood to fall by half a nat; the mean of both sides.

    That it may be another way to either side is what a threshold between two readings looks like.
    """

    def drop(step: float) -> float:
        x = best.copy()
        x[index] += step
        return top - objective(x)

    sides = []
    for sign, room in ((1.0, upper - best[index]), (-1.0, best[index] - lower)):
        if room > 1e-3 * scale:
            sides.append(_side(lambda step, sign=sign: drop(sign * step), 0.1 * scale, room))  # type: ignore[misc]
    return float(np.mean(sides)) if sides else float(upper - lower)


def _side(drop: Callable[[float], float], first: float, room: float) -> float:
    """The step at which `drop` is about half a nat, by doubling and halving; all the `room` if it never is."""
    low, high, step = 0.0, np.inf, min(first, room)
    for _ in range(_STEP_TRIES):
        fallen = drop(step)
        if 0.8 * _WANTED_DROP < fallen < 1.3 * _WANTED_DROP:
            return step
        if fallen < _WANTED_DROP:
            if step >= room:
                return room
            low = step
        else:
            high = step
        step = min(2.0 * step, room) if np.isinf(high) else 0.5 * (low + high)
        if high - low < 1e-3 * high:
            break
    return step


def _simplex(z: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    corners = np.tile(z, (z.size + 1, 1))
    for i in range(z.size):
        corners[i + 1, i] += 0.25 if z[i] + 0.25 <= upper[i] else -0.25
    return np.clip(corners, lower, upper)


def _bounds(free: Sequence[Free]) -> tuple[FloatArray, FloatArray, FloatArray]:
    return (
        np.array([part.lower for part in free]),
        np.array([part.upper for part in free]),
        np.array([part.scale for part in free]),
    )
