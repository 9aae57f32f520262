"""A sine of one frequency and amplitude in several runs, each with a phase of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray

MAINS_HZ: Final = (100.0, 120.0, 50.0, 60.0)

_HIGHEST_HZ = 130.0  # up to which frequencies are tried
_STEPS_PER_RESOLUTION = 4.0  # of the grid of frequencies, to one over the longest run's length
_LOWEST_HZ = 3.0  # from which frequencies are tried: slower changes go with the motion along the gradient
_MOST_READINGS = 1500  # of each run, its first ones
_CHUNK = 2000  # frequencies whose power is computed at once
_PEAKS = 3  # highest peaks that are kept wherever they lie
_MAINS_WIDTH_HZ = 0.6  # to either side of a mains frequency, where the strongest peak is kept too


@final
@dataclass(frozen=True)
class Peak:
    """A frequency at which the error swings.

    Attributes:
        phases_rad: of A·sin(2π·f·t + φ) in each run.
        constant: what the sine leaves of the mean error.
        left: standard deviation of what is left without the sine.
    """

    frequency_hz: float
    amplitude: float
    phases_rad: tuple[float, ...]
    constant: float
    left: float


def likeliest_frequencies(parts: Sequence[tuple[FloatArray, FloatArray]]) -> list[Peak]:
    """The strongest peaks from 3 to 130 Hz, and the strongest near each mains frequency.

    Changes slower than 3 Hz go with the motion along the gradient and are no flicker.

    Readings at an even pace cannot tell a frequency from its aliases. The peaks always include those near the mains'
    frequencies, so that the likelihood and the reader can choose.

    Args:
        parts: for each run its stamps (s) and errors, shape (readings,) each.
    """
    thinned = [(time_s[:_MOST_READINGS], error[:_MOST_READINGS]) for time_s, error in parts]
    longest_s = max(float(np.ptp(time_s)) for time_s, _ in thinned)
    if longest_s <= 0.0:
        return []
    step_hz = 1.0 / (_STEPS_PER_RESOLUTION * longest_s)
    grid = np.arange(_LOWEST_HZ, _HIGHEST_HZ, step_hz)
    power = np.concatenate([_power(part, thinned) for part in _chunks(grid)])
    chosen = list(_highest(grid, power, _PEAKS))
    for mains in MAINS_HZ:
        near = np.flatnonzero(np.abs(grid - mains) < _MAINS_WIDTH_HZ)
        if near.size:
            chosen.append(float(grid[near[np.argmax(power[near])]]))
    return [_peak(frequency, thinned) for frequency in dict.fromkeys(chosen)]


def _chunks(grid: FloatArray) -> Iterator[FloatArray]:
    for start in range(0, grid.size, _CHUNK):
        yield grid[start : start + _CHUNK]


def _power(frequencies: FloatArray, parts: Sequence[tuple[FloatArray, FloatArray]]) -> FloatArray:
    """The squares that a sine of each frequency takes away, shape (frequencies,)."""
    power = np.zeros(frequencies.size)
    for time_s, error in parts:
        turn = np.exp(-2j * np.pi * np.outer(frequencies, time_s))
        power += np.abs(turn @ (error - error.mean())) ** 2 * 2.0 / error.size
    return power


def _highest(grid: FloatArray, power: FloatArray, count: int) -> Iterator[float]:
    left = power.copy()
    for _ in range(min(count, left.size)):
        top = int(np.argmax(left))
        yield float(grid[top])
        around = int(2 * _STEPS_PER_RESOLUTION)
        left[max(0, top - around) : top + around + 1] = -np.inf


def _peak(frequency_hz: float, parts: Sequence[tuple[FloatArray, FloatArray]]) -> Peak:
    phases, squares, constant, left, count = [], 0.0, 0.0, 0.0, 0
    for time_s, error in parts:
        turn = 2.0 * np.pi * frequency_hz * time_s
        waves = np.column_stack([np.sin(turn), np.cos(turn), np.ones(turn.size)])
        weights, *_ = np.linalg.lstsq(waves, error, rcond=None)
        phases.append(float(np.arctan2(weights[1], weights[0])))
        squares += float(weights[0] ** 2 + weights[1] ** 2) * error.size
        constant += float(weights[2]) * error.size
        left += float(np.sum((error - waves @ weights) ** 2))
        count += error.size
    amplitude, scatter = float(np.sqrt(squares / count)), float(np.sqrt(left / count))
    return Peak(frequency_hz, amplitude, tuple(phases), constant / count, scatter)
