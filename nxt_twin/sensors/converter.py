"""The brick's 10-bit converter: whole readings that stop at either end."""

from __future__ import annotations

from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.intervals import log_interval_probability

HIGHEST_RAW: Final = 1023.0


def converted(level: FloatArray) -> FloatArray:
    """The readings of a level, raw; shape as `level`."""
    return np.clip(np.rint(level), 0.0, HIGHEST_RAW)


def interval_of(readings: FloatArray, mean: FloatArray, std: float) -> tuple[FloatArray, FloatArray]:
    """Between what standard scores the level lay that was read so; the last reading at either end takes all beyond."""
    low = np.where(readings <= 0.0, -np.inf, (readings - 0.5 - mean) / std)
    return low, np.where(readings >= HIGHEST_RAW, np.inf, (readings + 0.5 - mean) / std)


def log_probability_each(readings: FloatArray, mean: FloatArray, std: float, sensor: str) -> FloatArray:
    """The logarithm of the probability of each reading of a normal level, nats; 0 where it is NaN.

    Args:
        readings: raw, shape (polls,).
        mean: of the level, shape (polls,).
        std: of the level.
        sensor: whose readings they are, for errors.

    Raises:
        SensorError: the two differ in shape.
    """
    if readings.shape != mean.shape:
        raise SensorError("readings and truth differ in length", where=sensor)
    seen = ~np.isnan(readings)
    return np.where(
        seen, log_interval_probability(*interval_of(np.where(seen, readings, 0.0), mean, std)), 0.0
    )
