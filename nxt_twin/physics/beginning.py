"""Whether a recording begins with the machine standing still.

A smoother looks ahead of the first reading. Where a command acts from the first row on, it takes the motion that
follows for one that was there.
"""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.signals import Signals

_SPAN_S = 0.12
_SPAN_READINGS = 6
_FEWEST_READINGS = 3
_LAGS_S = np.geomspace(0.015, 0.5, 11)
_DELAYS_S = (0.0, 0.01, 0.02, 0.04, 0.08)
_AS_GOOD = 1.5  # times the error of a motion that need not begin at rest
_AS_NEAR = 0.5  # of the readings' step
_ANOTHER = 0.1  # of the largest command
_NOTHING = 1e-300  # a shape that has not begun
_CLEARLY_WORSE = 4.0  # times the error from rest


def begins_at_rest(signals: Signals) -> bool:
    """Whether the first readings follow, from rest, the command that holds from the first one on.

    Without a drive, they must not move until it changes. With one, a first-order lag of speed behind it is fitted to
    them, once from rest and once from any speed. Where a constant speed fits as well, nothing shows a rest.
    """
    if signals.is_speed:
        return False
    elapsed_s, moved = _first_readings(signals)
    if not _drives_at_once(signals):
        return bool(moved.size and np.abs(moved).max() <= signals.quantum)
    if elapsed_s.size < _FEWEST_READINGS:
        return False
    lag_s, delay_s = (each.reshape(-1, 1) for each in np.meshgrid(_LAGS_S, _DELAYS_S, indexing="ij"))
    still = _least(_without(moved, _from_rest(elapsed_s - delay_s, lag_s)))
    lag_s = _LAGS_S[:, None]
    risen, dying = _from_rest(elapsed_s, lag_s), _dying(elapsed_s, lag_s)
    moving = _least(_without(_without(moved, risen), _without(dying, risen)))
    steady = _least(_without(moved, elapsed_s[None]))
    return still <= max(_AS_GOOD * moving, _AS_NEAR * signals.quantum) and steady > _CLEARLY_WORSE * still


def _first_readings(signals: Signals) -> tuple[FloatArray, FloatArray]:
    """Stamps and readings under the first command, both counted from the first reading; without that reading."""
    known = np.flatnonzero(np.isfinite(signals.measured))
    if not known.size or known[0] != 0:
        return np.zeros(0), np.zeros(0)
    elapsed_s = signals.time_s[known] - signals.time_s[0]
    span_s = max(_SPAN_S, _SPAN_READINGS * signals.interval_s)
    rows = (elapsed_s > 0.0) & (elapsed_s <= min(span_s, _first_change_s(signals)))
    moved = signals.measured[known] - signals.measured[0]
    return elapsed_s[rows], moved[rows]


def _drives_at_once(signals: Signals) -> bool:
    """Whether the command that holds from the first reading on drives."""
    return bool(signals.command[_in_force(signals)] != 0.0)


def _first_change_s(signals: Signals) -> float:
    """How long after the first reading the command has become clearly another, s."""
    held = signals.command[_in_force(signals)]
    later = signals.command_time_s > signals.time_s[0]
    another = np.abs(signals.command - held) > _ANOTHER * np.abs(signals.command).max()
    changed = signals.command_time_s[later & another]
    return float(changed[0] - signals.time_s[0]) if changed.size else np.inf


def _in_force(signals: Signals) -> int:
    """The number of the command that holds from the first reading on."""
    return max(int(np.searchsorted(signals.command_time_s, signals.time_s[0], side="right")) - 1, 0)


def _from_rest(elapsed_s: FloatArray, lag_s: FloatArray) -> FloatArray:
    """Position under a constant command from rest, to a factor: t - τ(1 - exp(-t/τ)), shape (lags, readings)."""
    after = np.maximum(elapsed_s, 0.0)
    return np.asarray(after - _dying(after, lag_s))


def _dying(elapsed_s: FloatArray, lag_s: FloatArray) -> FloatArray:
    """Position while a speed dies away, to a factor: τ(1 - exp(-t/τ)), shape (lags, readings)."""
    return np.asarray(-lag_s * np.expm1(-elapsed_s / lag_s))


def _without(values: FloatArray, shapes: FloatArray) -> FloatArray:
    """The part of `values` that the best multiple of each of `shapes` leaves, shape (shapes, readings)."""
    size = np.maximum(np.sum(shapes**2, axis=1, keepdims=True), _NOTHING)
    return np.asarray(values - np.sum(values * shapes, axis=1, keepdims=True) / size * shapes)


def _least(left: FloatArray) -> float:
    """The least RMS of the rows."""
    return float(np.sqrt(np.mean(left**2, axis=1)).min())
