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
_SPAN_REFRESHED = 9  # refreshments of readings that a device holds: their moments are open
_FEWEST_READINGS = 3
_LAGS_S = np.geomspace(0.015, 0.5, 11)
_OF_THE_PLANT = 0.5  # of the lag that the plant has as given: its numbers may be off, but not by so many
_DELAYS_S = np.linspace(0.0, 0.08, 17)
_LATE_S = _DELAYS_S[_DELAYS_S >= 0.02]  # a start under a shorter delay is hardly told from one at once
_NOT_OF_FIRST_ORDER = 0.007  # of the way: what friction and the winding leave of such a lag
_AS_GOOD_NATS = 4.0  # that a motion which need not begin at rest may gain
_NEAR = 4.0  # times the variance that the readings' step and such a lag leave
_SHOWN_NATS = 8.0  # that a start from rest gains over a constant speed
_ANOTHER = 0.1  # of the largest command
_NOTHING = 1e-300  # a shape that has not begun


def begins_at_rest(signals: Signals) -> bool:
    """Whether the first readings follow, from rest, the commands that hold from the first one on.

    Before a first drive they must not move. Under one, a first-order lag of speed behind the commands is fitted to
    them, once from rest and once from any speed. Where a constant speed fits as well, nothing shows a rest. In doubt
    they do not: a rest that was none costs degrees, and a run-in a third of a second.
    """
    if signals.is_speed:
        return False
    return _stands(signals, *_first_readings(signals)) or _follows(signals)


def goes_off_at_once(signals: Signals) -> bool:
    """Whether the first readings follow the first command from rest at once, and not from when a late one could act.

    That command was in force before then, and the machine was let go with the first reading.
    """
    if signals.is_speed or signals.command[_in_force(signals)] == 0.0:
        return False
    elapsed_s, moved, _ = _first_moments(signals)
    if elapsed_s.size < _FEWEST_READINGS:
        return False
    lag_s = _lags_s(signals)[:, None]
    at_once = _least(_without(moved, _from_rest(signals, elapsed_s, lag_s)))
    late = min(_least(_without(moved, _from_rest(signals, elapsed_s - late_s, lag_s))) for late_s in _LATE_S)
    variance = signals.quantum**2 / 12.0 + (_NOT_OF_FIRST_ORDER * np.abs(moved).max()) ** 2
    shown = 0.5 * moved.size * (late**2 - at_once**2) / max(variance, _NOTHING)
    return bool(at_once**2 < _NEAR * variance and shown > _SHOWN_NATS)


def _stands(signals: Signals, elapsed_s: FloatArray, moved: FloatArray) -> bool:
    """Whether nothing drives at first, and nothing moves until something does."""
    if signals.command[_in_force(signals)] != 0.0:
        return False
    before = moved[elapsed_s <= _first_change_s(signals)]
    return bool(before.size and np.abs(before).max() <= signals.quantum)


def _follows(signals: Signals) -> bool:
    """Whether the readings follow the commands as from rest, and show that it was one."""
    elapsed_s, moved, open_s = _first_moments(signals)
    if elapsed_s.size < _FEWEST_READINGS:
        return False
    lag_s, delay_s = (each.reshape(-1, 1) for each in np.meshgrid(_lags_s(signals), _DELAYS_S, indexing="ij"))
    still = _least(_without(moved, _from_rest(signals, elapsed_s - delay_s, lag_s)))
    lag_s = _LAGS_S[:, None]
    risen, dying = _from_rest(signals, elapsed_s, lag_s), _dying(elapsed_s, lag_s)
    moving = _least(_without(_without(moved, risen), _without(dying, risen)))
    steady = _least(_without(moved, elapsed_s[None]))
    rounding = signals.quantum**2 / 12.0
    if open_s.any():
        rounding += float(np.mean((open_s * np.gradient(moved, elapsed_s)) ** 2)) / 12.0
    variance = rounding + (_NOT_OF_FIRST_ORDER * np.abs(moved).max()) ** 2
    readings = 0.5 * moved.size
    gained = readings * (still**2 - moving**2) / max(rounding, moving**2, _NOTHING)
    shown = readings * (steady**2 - still**2) / max(variance, _NOTHING)
    return bool(still**2 < _NEAR * variance and gained < _AS_GOOD_NATS and shown > _SHOWN_NATS)


def _lags_s(signals: Signals) -> FloatArray:
    """The lags that are tried: a quicker start than the plant's own was on its way before the first reading."""
    least_s = _OF_THE_PLANT * signals.lag_s
    return np.geomspace(max(_LAGS_S[0], least_s), max(_LAGS_S[-1], 2.0 * least_s), _LAGS_S.size)


def _first_readings(signals: Signals) -> tuple[FloatArray, FloatArray]:
    """Stamps and readings soon after the first one, both counted from it; without that reading."""
    known = np.flatnonzero(np.isfinite(signals.measured))
    if not known.size or known[0] != 0:
        return np.zeros(0), np.zeros(0)
    elapsed_s = signals.time_s[known] - signals.time_s[0]
    rows = (elapsed_s > 0.0) & (elapsed_s <= max(_SPAN_S, _SPAN_READINGS * signals.interval_s))
    moved = signals.measured[known] - signals.measured[0]
    return elapsed_s[rows], moved[rows]


def _first_moments(signals: Signals) -> tuple[FloatArray, FloatArray, FloatArray]:
    """As `_first_readings`, and how far the moments are open, s; of held readings those that were new, as taken."""
    ages = signals.ages[:, :2]
    held = ages[:, 1] >= 0.0
    if not held.any():
        elapsed_s, moved = _first_readings(signals)
        return elapsed_s, moved, np.zeros(elapsed_s.size)
    taken_s = signals.time_s - signals.time_s[0] - ages[:, 0] - 0.5 * ages[:, 1]
    new = held & (np.diff(signals.measured, prepend=np.nan) != 0.0) & np.isfinite(signals.measured)
    rows = np.flatnonzero(new & (taken_s > 0.0) & (taken_s <= _SPAN_REFRESHED * signals.refreshed_s))
    rows = rows[np.diff(taken_s[rows], prepend=0.0) > 0.0]
    return taken_s[rows], signals.measured[rows] - signals.measured[0], ages[rows, 1]


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


def _from_rest(signals: Signals, elapsed_s: FloatArray, lag_s: FloatArray) -> FloatArray:
    """Position under the commands from rest, to a factor, shape (lags, readings).

    A command of 1 leads to t - τ(1 - exp(-t/τ)); each change of command adds its own.
    """
    first = _in_force(signals)
    begun_s = np.maximum(signals.command_time_s[first:] - signals.time_s[0], 0.0)
    soon = begun_s < elapsed_s.max()
    steps = np.diff(signals.command[first:], prepend=0.0)[soon]
    position = np.zeros(np.broadcast_shapes(elapsed_s.shape, lag_s.shape))
    for step, since_s in zip(steps[steps != 0.0], begun_s[soon][steps != 0.0], strict=True):
        after = np.maximum(elapsed_s - since_s, 0.0)
        position += step * (after - _dying(after, lag_s))
    return position


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
