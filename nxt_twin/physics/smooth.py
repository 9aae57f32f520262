"""Position and speed from readings alone, for starting a run in the middle of a recording."""

from __future__ import annotations

import numpy as np
from numba import njit

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.signals import Signals

_HALF_WINDOW_S = 0.03
_HALF_WINDOW_SAMPLES = 4


def half_window_s(signals: Signals) -> float:
    """How far the smoother looks to either side of a reading, s."""
    return max(_HALF_WINDOW_S, _HALF_WINDOW_SAMPLES * signals.interval_s)


def smoothed(signals: Signals) -> tuple[FloatArray, FloatArray]:
    """Position and speed at each stamp, shape (samples,), by a local quadratic through the readings.

    Where too few readings are near, the position is the last reading's and the speed zero.
    """
    rows = signals.time_s.size
    known = np.isfinite(signals.measured)
    position = np.zeros(rows)
    speed = np.zeros(rows)
    _local_quadratic(
        signals.time_s,
        signals.time_s[known],
        signals.measured[known],
        half_window_s(signals),
        position,
        speed,
    )
    if signals.is_speed:
        moved = np.concatenate([[0.0], np.cumsum(np.diff(signals.time_s) * position[1:])])
        return moved, position
    return position, speed


@njit(cache=True, nogil=True)
def _local_quadratic(  # type: ignore[no-untyped-def]  # noqa: ANN202  # compiled: numba infers the types
    stamps,  # noqa: ANN001
    time_s,  # noqa: ANN001
    reading,  # noqa: ANN001
    half_s,  # noqa: ANN001
    position,  # noqa: ANN001
    speed,  # noqa: ANN001
):
    low = 0
    high = 0
    for k in range(stamps.shape[0]):
        t0 = stamps[k]
        while low < time_s.shape[0] and time_s[low] < t0 - half_s:
            low += 1
        while high < time_s.shape[0] and time_s[high] <= t0 + half_s:
            high += 1
        if high - low < 4:
            position[k] = reading[min(max(high - 1, 0), time_s.shape[0] - 1)]
            speed[k] = 0.0
            continue
        n1 = n2 = n3 = n4 = r0 = r1 = r2 = (
            0.0  # the normal equations; written out, they take a tenth of the time
        )
        for i in range(low, high):
            x = (time_s[i] - t0) / half_s
            n1 += x
            n2 += x * x
            n3 += x * x * x
            n4 += x * x * x * x
            r0 += reading[i]
            r1 += x * reading[i]
            r2 += x * x * reading[i]
        n0 = high - low + 1e-9
        by1, by2 = n1 / n0, n2 / n0
        left1 = n2 + 1e-9 - by1 * n1
        across = n3 - by1 * n2
        further = across / left1
        left2 = n4 + 1e-9 - by2 * n2 - further * across
        r1 -= by1 * r0
        bend = (r2 - by2 * r0 - further * r1) / left2
        slope = r1 / left1 - further * bend
        position[k] = r0 / n0 - by1 * slope - by2 * bend
        speed[k] = slope / half_s
