"""Families of inputs: duty and drive mode as functions of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.recording.columns import DRIVE_MODES

DRIVE, FLOAT, COAST, BRAKE = (DRIVE_MODES.index(mode) for mode in DRIVE_MODES)
REST_S: Final = 0.3


@final
@dataclass(frozen=True)
class CommandRows:
    """Commands for each row: duty in whole per cent and mode (index into `DRIVE_MODES`), shape (rows,)."""

    power_pct: FloatArray
    mode: IntArray


def _holds(rng: Generator, time_s: FloatArray, shortest_s: float, longest_s: float) -> IntArray:
    """Number, for each row, the hold that it belongs to; holds last a random time."""
    count = int(time_s[-1] / shortest_s) + 2
    ends = np.cumsum(rng.uniform(shortest_s, longest_s, count))
    return np.searchsorted(ends, time_s, side="right")


def _driven(time_s: FloatArray, power_pct: FloatArray) -> CommandRows:
    settled = np.where(time_s < REST_S, 0.0, power_pct)
    rounded = np.clip(np.round(settled), -100.0, 100.0).astype(np.float64)
    return CommandRows(rounded, np.zeros(time_s.size, dtype=np.int64))


def random_steps(rng: Generator, time_s: FloatArray) -> CommandRows:
    """Random levels, every fifth at rest, each held 0.3 to 1.5 s."""
    hold = _holds(rng, time_s, 0.3, 1.5)
    levels = rng.uniform(-100.0, 100.0, hold[-1] + 1)
    levels[rng.random(levels.size) < 0.2] = 0.0
    return _driven(time_s, levels[hold])


def multisine(rng: Generator, time_s: FloatArray) -> CommandRows:
    """Five sines between 0.1 and 3 Hz."""
    frequency_hz = np.exp(rng.uniform(np.log(0.1), np.log(3.0), 5))
    phase = rng.uniform(0.0, 2.0 * np.pi, 5)
    waves = np.sin(2.0 * np.pi * frequency_hz * time_s[:, None] + phase)
    return _driven(time_s, rng.uniform(30.0, 45.0) * waves.sum(axis=1))


def ramps(rng: Generator, time_s: FloatArray) -> CommandRows:
    """Slow ramps through zero between random levels of alternating sign, with rests in between."""
    knots_s, knots_pct = [REST_S], [0.0]
    side = rng.choice((-1.0, 1.0))
    while knots_s[-1] < time_s[-1]:
        level = side * rng.uniform(20.0, 90.0)
        knots_s.append(knots_s[-1] + rng.uniform(1.0, 3.0))
        knots_pct.append(level)
        side = -side
        if rng.random() < 0.4:
            knots_s += [knots_s[-1] + rng.uniform(0.5, 1.5), knots_s[-1] + rng.uniform(1.6, 2.5)]
            knots_pct += [0.0, 0.0]
    return _driven(time_s, np.interp(time_s, knots_s, knots_pct))


def reversals(rng: Generator, time_s: FloatArray) -> CommandRows:
    """To and fro at random levels, each held 0.12 to 0.6 s."""
    hold = _holds(rng, time_s, 0.12, 0.6)
    levels = rng.uniform(15.0, 100.0, hold[-1] + 1) * np.where(np.arange(hold[-1] + 1) % 2, -1.0, 1.0)
    return _driven(time_s, levels[hold])


def chirp(rng: Generator, time_s: FloatArray) -> CommandRows:
    """A sine whose frequency rises from 0.1 to 2–6 Hz, about a small slow bias."""
    highest_hz = rng.uniform(2.0, 6.0)
    rate = np.log(highest_hz / 0.1) / time_s[-1]
    phase = 2.0 * np.pi * 0.1 * (np.exp(rate * time_s) - 1.0) / rate
    bias = rng.uniform(-15.0, 15.0) * np.sin(2.0 * np.pi * time_s / rng.uniform(6.0, 12.0))
    return _driven(time_s, rng.uniform(50.0, 85.0) * np.sin(phase) + bias)


def coast_downs(rng: Generator, time_s: FloatArray) -> CommandRows:
    """Spin up, then coast, brake or go on with an open off phase."""
    hold = _holds(rng, time_s, 0.4, 1.2)
    count = int(hold[-1]) + 1
    levels = rng.uniform(25.0, 100.0, count) * rng.choice((-1.0, 1.0), count)
    kinds = rng.choice((COAST, FLOAT, BRAKE), count, p=(0.5, 0.3, 0.2))
    mode = np.where(np.arange(count) % 2, kinds, DRIVE)
    levels[(mode == COAST) | (mode == BRAKE)] = 0.0
    driven = _driven(time_s, levels[hold])
    return CommandRows(driven.power_pct, np.where(time_s < REST_S, DRIVE, mode[hold]).astype(np.int64))


FAMILIES: Final[dict[str, Callable[[Generator, FloatArray], CommandRows]]] = {
    "steps": random_steps,
    "multisine": multisine,
    "ramps": ramps,
    "reversals": reversals,
    "chirp": chirp,
    "coast_downs": coast_downs,
}
