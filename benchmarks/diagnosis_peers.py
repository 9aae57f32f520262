"""Two plain recipes that a user could apply to these recordings instead, each at its own pace."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pysindy
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.signals import Signals

_MOST_EVALUATIONS = 8
_EDGE_RAD_S = 0.05  # within which the plain model smooths dry friction, as a user of a solver has to
_THRESHOLDS = (0.3, 1.0, 3.0, 10.0)  # rad/s², of a term's ordinary contribution

Term = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""A shape of torque from angle (rad), speed (rad/s) and voltage (V)."""


def _sign(speed: FloatArray) -> FloatArray:
    return np.asarray(np.tanh(speed / _EDGE_RAD_S))


PLAIN: dict[str, Term] = {
    "voltage": lambda _, __, volts: volts,
    "damping": lambda _, speed, __: speed,
    "coulomb": lambda _, speed, __: _sign(speed),
}
CANDIDATES: dict[str, Term] = {
    "stiction": lambda _, speed, __: _sign(speed) * np.exp(-(speed**2)),
    "quadratic_drag": lambda _, speed, __: speed * np.abs(speed),
    "constant_load": lambda _, speed, __: np.ones_like(speed),
    "gravity_load": lambda angle, _, __: np.sin(angle),
    "spring_load": lambda angle, _, __: angle,
    "battery_sag": lambda _, __, volts: volts * np.abs(volts),
}


class Peer(NamedTuple):
    """The names that a recipe gave, and its time."""

    named: tuple[str, ...]
    taken_s: float
    words: str


def one_by_one(recordings: Sequence[Signals]) -> Peer:
    """Each candidate added to the plain motor and fitted by `least_squares` over `solve_ivp`, the best named.

    Whole recordings in free run from rest, and few evaluations: the words say so.
    """
    began = time.perf_counter()
    costs = {"": _fitted_cost(recordings, None)}
    for name, term in CANDIDATES.items():
        costs[name] = _fitted_cost(recordings, term)
    taken_s = time.perf_counter() - began
    best = min(CANDIDATES, key=lambda name: costs[name])
    return Peer(
        (best,) if costs[best] < 0.9 * costs[""] else (),
        taken_s,
        f"{len(CANDIDATES)} candidates, whole recordings, {_MOST_EVALUATIONS} steps each at most",
    )


def _fitted_cost(recordings: Sequence[Signals], term: Term | None) -> float:
    def errors(x: FloatArray) -> FloatArray:
        runs = [_free_run(signals, x, term) for signals in recordings]
        return np.concatenate([run - want for run, want in zip(runs, measured, strict=True)])

    measured = [_read(signals)[1] for signals in recordings]
    start = np.array([50.0, 25.0, 7.0, *([0.1] if term else [])])
    return float(
        least_squares(errors, start, x_scale=np.maximum(start, 1.0), max_nfev=_MOST_EVALUATIONS).cost
    )


def _read(signals: Signals) -> tuple[FloatArray, FloatArray]:
    """Times and angles, since the beginning."""
    known = np.isfinite(signals.measured)
    return signals.time_s[known], signals.measured[known] - signals.measured[known][0]


def _free_run(signals: Signals, x: FloatArray, term: Term | None) -> FloatArray:
    """Angles at the readings, from rest, one call of the solver a command."""
    time_s, _ = _read(signals)
    ends = np.append(signals.command_time_s[1:], np.inf)
    volts = signals.command * signals.command_supply_v
    angle, state = np.zeros(time_s.size), np.zeros(2)
    for start, end, held in zip(signals.command_time_s, np.minimum(ends, time_s[-1]), volts, strict=True):
        if end <= start:
            break
        due = (time_s > start) & (time_s <= end)
        level = np.array(held)

        def rates(_: float, state: FloatArray, level: FloatArray = level) -> tuple[float, float]:
            push = x[0] * level - x[1] * state[1] - x[2] * _sign(state[1])
            extra = -x[3] * term(state[0], state[1], level) if term else 0.0
            return float(state[1]), float(push + extra)

        found = solve_ivp(
            rates,
            (start, end),
            state,
            method="LSODA",
            t_eval=np.union1d(time_s[due], [end]),
            rtol=1e-5,
            atol=1e-6,
        )
        angle[due] = found.y[0, : int(due.sum())]
        state = found.y[:, -1]
    return angle


def sparse_regression(recordings: Sequence[Signals]) -> Peer:
    """The discrepancy recipe with PySINDy: smoothed derivatives, a library that holds the right terms, STLSQ.

    The plain terms take part, so that the baseline is re-fitted; what else survives the threshold is what is named.
    The threshold is the one with the best Akaike criterion of a few.
    """
    began = time.perf_counter()
    states, volts, accelerations = (
        np.concatenate(part) for part in zip(*map(_smooth, recordings), strict=True)
    )
    terms = {**PLAIN, **CANDIDATES}
    features = np.column_stack([term(states[:, 0], states[:, 1], volts) for term in terms.values()])
    sizes = np.maximum(np.sqrt(np.mean(features**2, axis=0)), 1e-9)
    best: tuple[float, tuple[str, ...]] | None = None
    for threshold in _THRESHOLDS:
        model = pysindy.SINDy(
            optimizer=pysindy.STLSQ(threshold=threshold, alpha=1e-3),
            feature_library=pysindy.IdentityLibrary(),
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model.fit(
                features / sizes, t=1.0, x_dot=np.repeat(accelerations[:, None], features.shape[1], axis=1)
            )
        weights = model.coefficients()[0]
        left = accelerations - features / sizes @ weights
        criterion = left.size * np.log(np.mean(left**2)) + 2.0 * np.count_nonzero(weights)
        names = tuple(
            name for name, weight in zip(terms, weights, strict=True) if weight and name in CANDIDATES
        )
        if best is None or criterion < best[0]:
            best = (float(criterion), names)
    named = best[1] if best else ()
    return Peer(
        named,
        time.perf_counter() - began,
        f"{len(terms)} terms, {states.shape[0]} readings, whole recordings",
    )


def _smooth(signals: Signals) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angle and speed, voltage, and acceleration on a regular grid of 10 ms, by Savitzky and Golay over 90 ms."""
    known = np.isfinite(signals.measured)
    grid = np.arange(signals.time_s[0], signals.time_s[-1], 0.01)
    angle = np.interp(grid, signals.time_s[known], signals.measured[known])
    smooth = [savgol_filter(angle, 9, 3, deriv=order, delta=0.01) for order in range(3)]
    row = np.maximum(np.searchsorted(signals.command_time_s, grid, side="right") - 1, 0)
    volts = (signals.command * signals.command_supply_v)[row]
    return np.column_stack(smooth[:2]), volts, np.asarray(smooth[2])
