"""A sensor that measures at its own pace: which polls see the same measurement.

Pings come at whole multiples of the period on the recording's own clock.
"""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray


def ping_numbers(time_s: FloatArray, period_s: float) -> IntArray:
    """The number of the last ping before each poll, shape (polls,)."""
    return np.floor(time_s / period_s + 1e-9).astype(np.int64)


def first_polls(numbers: IntArray) -> BoolArray:
    """Which polls are the first to see their ping, shape (polls,)."""
    return np.concatenate(([True], np.diff(numbers) != 0)) if numbers.size else np.zeros(0, dtype=np.bool_)


def at_pings(values: FloatArray, time_s: FloatArray, period_s: float) -> FloatArray:
    """The truth at the last ping before each poll, by straight lines between polls, shape (polls,)."""
    when = ping_numbers(time_s, period_s) * period_s
    return np.asarray(np.interp(when, time_s, values), dtype=np.float64)
