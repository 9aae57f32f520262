"""How a host polls: at which rate, how regularly, and how often something else keeps it busy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray

RATES_HZ: Final = (20.0, 30.0, 50.0, 50.0, 80.0, 100.0, 100.0, 150.0, 200.0, 300.0, 500.0)
MOST_ROWS: Final = 24_000
SHORTEST_S: Final = 5.0
UNEVEN: Final = 0.25


@final
@dataclass(frozen=True)
class Habits:
    """What all recordings of a case have in common.

    Attributes:
        recordings: how many.
        duration_s: how long the longest is.
        uneven: by which share the others are shorter at most.
        rate_hz: polls a second.
        jitter: standard deviation of the time between two polls, in periods.
        stall_chance: how often a poll is late by far.
        stall_s: by how much at most.
        step_deg: the encoder's step.
        battery_every: rows between two readings of the battery; 0: it is read in the first row only.
    """

    recordings: int
    duration_s: float
    uneven: float
    rate_hz: float
    jitter: float
    stall_chance: float
    stall_s: float
    step_deg: float
    battery_every: int

    @property
    def poll_s(self) -> float:
        """The usual time between two polls, s."""
        return 1.0 / self.rate_hz


def draw_habits(
    rng: Generator,
    steps_deg: tuple[float, ...],
    *,
    longest_s: float,
    duration_s: float | None,
    least_recordings: int,
) -> Habits:
    """Draw them; `longest_s` bounds the time of all recordings together, `duration_s` fixes that of each.

    Half of the cases are three recordings of about 15 s; the others are one to eight of 5 s and more.
    """
    usual = rng.random() < 0.5
    count = 3 if usual else int(rng.choice((1, 2, 3, 4, 5, 6, 8)))
    count = max(count, least_recordings)
    together_s = 20.0 * (longest_s / 20.0) ** float(rng.random() ** 1.5)
    each_s = float(rng.uniform(10.0, 20.0)) if usual else max(SHORTEST_S, together_s / count)
    each_s = duration_s or round(each_s, 1)
    rate_hz = float(rng.choice(RATES_HZ))
    while rate_hz > RATES_HZ[0] and rate_hz * each_s * count > MOST_ROWS:
        rate_hz = max(RATES_HZ[0], 0.7 * rate_hz)
    return Habits(
        recordings=count,
        duration_s=each_s,
        uneven=0.0 if usual or duration_s else UNEVEN,
        rate_hz=rate_hz,
        jitter=float(rng.choice((0.0, 0.02, 0.1, 0.25))),
        stall_chance=float(rng.choice((0.0, 0.001, 0.003))),
        stall_s=float(rng.uniform(0.04, 0.3)),
        step_deg=float(rng.choice(steps_deg)),
        battery_every=int(rng.choice((1, 10, 25, 60, 0), p=(0.15, 0.3, 0.3, 0.15, 0.1))),
    )


def draw_length_s(rng: Generator, habits: Habits) -> float:
    """How long one recording is, s."""
    if habits.uneven == 0.0:
        return habits.duration_s
    shorter = habits.duration_s * (1.0 - habits.uneven * float(rng.random()))
    return max(min(SHORTEST_S, habits.duration_s), shorter)


def polls_s(rng: Generator, habits: Habits, duration_s: float, before_s: float = 0.0) -> FloatArray:
    """True times of the polls, from about `-before_s` to about `duration_s`, one of them zero, s."""
    times_s = _from_zero_s(rng, habits, before_s + duration_s)
    return np.asarray(times_s - times_s[int(np.searchsorted(times_s, before_s))])


def _from_zero_s(rng: Generator, habits: Habits, duration_s: float) -> FloatArray:
    count = int(1.3 * duration_s * habits.rate_hz) + 10
    gaps = np.maximum(1.0 + habits.jitter * rng.standard_normal(count), 0.35) / habits.rate_hz
    late = rng.random(count) < habits.stall_chance
    gaps[late] += rng.uniform(0.3, 1.0, int(late.sum())) * habits.stall_s
    times_s = np.round(np.concatenate([[0.0], np.cumsum(gaps)]), 6)
    return np.asarray(times_s[times_s <= duration_s], dtype=np.float64)
