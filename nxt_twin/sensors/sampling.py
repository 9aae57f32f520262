"""What readings alone tell of a sensor, without a ruler beside it: their step, their pace, and their noise.

A target that moves smoothly is close to a straight line over a few readings. What scatters round such lines is
the rounding (a twelfth of a step squared) and the sensor's noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.errors import SensorError

_LINE_READINGS: Final = 5
_FEWEST: Final = 20
_STALL: Final = 1.3
_FINEST_STEP: Final = 1e-3


@final
@dataclass(frozen=True)
class Sampling:
    """How a sensor was read.

    Attributes:
        quantum: the smallest step of its readings, in their unit.
        period_s: the median time between two readings, and
        period_std_s: its standard error.
        jitter_s: standard deviation of the time between readings, stalls left out.
        stalls: intervals more than 1.3 times as long.
        noise: standard deviation of the readings before rounding, in their unit; 0 if rounding explains all.
        noise_std: its standard error.
        held_share: the share of readings that only repeat the last although the line moves on by more than a step.
    """

    quantum: float
    period_s: float
    period_std_s: float
    jitter_s: float
    stalls: int
    noise: float
    noise_std: float
    held_share: float


def sampling_of(time_s: FloatArray, readings: FloatArray, no_reading: float | None = None) -> Sampling:
    """Tell step, pace and noise from readings.

    Args:
        time_s: stamps, s, shape (polls,).
        readings: shape (polls,), NaN where not sampled.
        no_reading: the value that stands for none, 255 of the ultrasonic sensor.

    Raises:
        SensorError: fewer than 20 readings, or all of them equal.
    """
    known = np.isfinite(readings)
    if no_reading is not None:
        known &= readings != no_reading
    t, y = time_s[known], readings[known]
    if y.size < _FEWEST or np.ptp(y) == 0.0:
        mend = f"at least {_FEWEST}, of a target that moves"
        raise SensorError("too few different readings to tell their step and pace", where="sensor", mend=mend)
    quantum = _step(y)
    gaps = np.diff(t)
    period = float(np.median(gaps))
    usual = gaps[gaps < _STALL * period]
    left, moves = _round_lines(t, y)
    variance = float(np.mean(left))
    doubt = float(np.std(left) / np.sqrt(left.size / _LINE_READINGS))
    noise = float(np.sqrt(max(variance - quantum**2 / 12.0, 0.0)))
    held = (np.diff(y)[: moves.size] == 0.0) & (np.abs(moves) > quantum)
    moving = np.abs(moves) > quantum
    return Sampling(
        quantum=quantum,
        period_s=period,
        period_std_s=float(1.2533 * np.std(usual) / np.sqrt(usual.size)),
        jitter_s=float(np.std(usual)),
        stalls=int(gaps.size - usual.size),
        noise=noise,
        noise_std=doubt / (2.0 * max(noise, np.sqrt(doubt))),
        held_share=float(held.sum() / moving.sum()) if moving.any() else 0.0,
    )


def _step(readings: FloatArray) -> float:
    """The largest step of which all differences are whole multiples, to a thousandth."""
    differences = np.unique(np.abs(np.diff(np.unique(readings))))
    whole = np.rint(differences / _FINEST_STEP).astype(np.int64)
    return float(np.gcd.reduce(whole)) * _FINEST_STEP


def _round_lines(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Squared errors (unbiased) round lines through each few neighbours, and by how much each line moves a poll."""
    squares, moves = [], []
    for begin in range(y.size - _LINE_READINGS + 1):
        part = slice(begin, begin + _LINE_READINGS)
        x = t[part] - t[part].mean()
        slope = float(x @ y[part] / max(float(x @ x), 1e-12))
        error = y[part] - y[part].mean() - slope * x
        squares.append(float(error @ error) / (_LINE_READINGS - 2))
        moves.append(slope * float(np.mean(np.diff(t[part]))))
    return np.array(squares), np.array(moves)
