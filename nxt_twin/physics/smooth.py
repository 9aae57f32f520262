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
        normal = np.zeros((3, 3))
        right = np.zeros(3)
        for i in range(low, high):
            x = (time_s[i] - t0) / half_s
            row = np.array([1.0, x, x * x])
            for a in range(3):
                right[a] += row[a] * reading[i]
                for b in range(3):
                    normal[a, b] += row[a] * row[b]
        if high - low < 4:
            position[k] = reading[min(max(high - 1, 0), time_s.shape[0] - 1)]
            speed[k] = 0.0
            continue
        for a in range(3):
            normal[a, a] += 1e-9
        solution = np.linalg.solve(normal, right)
        position[k] = solution[0]
        speed[k] = solution[1] / half_s
