"""The programs of a host: by hand, in steps, by stairs, in waves, slow, saturated, coasting, or in its own loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Protocol, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray, IntArray

DRIVE, FLOAT, COAST, BRAKE = range(4)
QUIET_S: Final = 0.25


class Loop(Protocol):
    """Decides on the duty at each poll, from what it reads."""

    def command(self, time_s: float, read_deg: float) -> float:
        """Duty in per cent at one poll."""


@final
class Played:
    """A duty and a mode as functions of time, given by knots; held between them, or ramped."""

    def __init__(self, knots_s: FloatArray, duty_pct: FloatArray, mode: IntArray, *, ramped: bool) -> None:
        self._knots_s, self._duty_pct, self._mode, self._ramped = knots_s, duty_pct, mode, ramped

    def table(self, time_s: FloatArray) -> tuple[FloatArray, IntArray]:
        """Duty in whole per cent and mode for all polls."""
        last = np.clip(np.searchsorted(self._knots_s, time_s, side="right") - 1, 0, None)
        ramp = np.interp(time_s, self._knots_s, self._duty_pct)
        duty = np.where(time_s < QUIET_S, 0.0, ramp if self._ramped else self._duty_pct[last])
        mode = np.where(time_s < QUIET_S, DRIVE, self._mode[last])
        return np.clip(np.rint(duty), -100.0, 100.0), mode.astype(np.int64)


Program = Played | Loop


@final
class AngleLoop:
    """A position loop of the host: proportional and derivative action on what it has read."""

    def __init__(self, knots_s: FloatArray, goals_deg: FloatArray, gain: float, damping_s: float) -> None:
        self._knots_s, self._goals_deg, self._gain, self._damping_s = knots_s, goals_deg, gain, damping_s
        self._last = (0.0, 0.0)
        self._started = False

    def command(self, time_s: float, read_deg: float) -> float:
        """Duty at one poll."""
        if not self._started:
            self._last, self._started, self._origin_deg = (time_s, read_deg), True, read_deg
        before_s, before_deg = self._last
        speed = (read_deg - before_deg) / (time_s - before_s) if time_s > before_s else 0.0
        self._last = (time_s, read_deg)
        goal = (
            self._origin_deg + self._goals_deg[int(np.searchsorted(self._knots_s, time_s, side="right")) - 1]
        )
        return float(
            np.clip(np.rint(self._gain * (goal - read_deg - self._damping_s * speed)), -100.0, 100.0)
        )


@final
class SpeedLoop:
    """A speed loop of the host: integral and proportional action on the smoothed speed of the readings."""

    def __init__(
        self, knots_s: FloatArray, goals_dps: FloatArray, gain: float, integral_per_s: float
    ) -> None:
        self._knots_s, self._goals_dps, self._gain, self._integral_per_s = (
            knots_s,
            goals_dps,
            gain,
            integral_per_s,
        )
        self._last: tuple[float, float] | None = None
        self._speed, self._sum = 0.0, 0.0

    def command(self, time_s: float, read_deg: float) -> float:
        """Duty at one poll."""
        before_s, before_deg = self._last or (time_s, read_deg)
        gap_s = time_s - before_s
        if gap_s > 0.0:
            self._speed += min(1.0, gap_s / 0.06) * ((read_deg - before_deg) / gap_s - self._speed)
        self._last = (time_s, read_deg)
        goal = self._goals_dps[int(np.searchsorted(self._knots_s, time_s, side="right")) - 1]
        error = goal - self._speed
        self._sum = float(np.clip(self._sum + self._integral_per_s * error * gap_s, -100.0, 100.0))
        return float(np.clip(np.rint(self._gain * error + self._sum), -100.0, 100.0))


def _knots(rng: Generator, duration_s: float, shortest_s: float, longest_s: float) -> FloatArray:
    count = int(duration_s / shortest_s) + 3
    return np.concatenate([[0.0], QUIET_S + np.cumsum(rng.uniform(shortest_s, longest_s, count))])


def _driven(knots_s: FloatArray, duty_pct: FloatArray, *, ramped: bool = False) -> Played:
    return Played(knots_s, duty_pct, np.zeros(knots_s.size, dtype=np.int64), ramped=ramped)


def by_hand(rng: Generator, duration_s: float) -> Program:
    """A lever moved by hand: uneven ramps and pauses, no two alike, mostly within half of the range."""
    knots_s = _knots(rng, duration_s, 0.12, 0.9)
    duty = np.clip(rng.normal(0.0, 45.0, knots_s.size), -100.0, 100.0)
    for knot in np.flatnonzero(rng.random(knots_s.size) < 0.3):
        duty[knot] = duty[knot - 1] if knot else 0.0
    duty[rng.random(knots_s.size) < 0.12] = 0.0
    return _driven(knots_s, duty, ramped=True)


def random_steps(rng: Generator, duration_s: float) -> Program:
    """Levels anywhere in the range, some at rest."""
    knots_s = _knots(rng, duration_s, 0.25, 1.6)
    duty = rng.uniform(-100.0, 100.0, knots_s.size)
    duty[rng.random(knots_s.size) < 0.18] = 0.0
    return _driven(knots_s, duty)


def one_step(rng: Generator, duration_s: float) -> Program:
    """One level, held long, then nothing; again at another level where there is time."""
    knots_s = _knots(rng, duration_s, 1.5, 4.0)
    duty = rng.uniform(30.0, 100.0, knots_s.size) * rng.choice((-1.0, 1.0), knots_s.size)
    duty[1::2] = 0.0
    return _driven(knots_s, duty)


def stairs(rng: Generator, duration_s: float) -> Program:
    """Levels that rise evenly to the highest and fall again, then likewise the other way."""
    knots_s = _knots(rng, duration_s, 0.5, 0.9)
    steps, highest = int(rng.integers(4, 10)), float(rng.uniform(60.0, 100.0))
    place = np.arange(knots_s.size) % (4 * steps)
    level = np.interp(place, np.array([0, 1, 3, 4]) * steps, [0.0, highest, -highest, 0.0])
    return _driven(knots_s, level * rng.choice((-1.0, 1.0)))


def wave(rng: Generator, duration_s: float) -> Program:
    """A sine whose frequency rises from below one to several hertz."""
    knots_s = np.arange(0.0, duration_s + 1.0, 0.02)
    slowest_hz, fastest_hz = float(rng.uniform(0.2, 0.6)), float(rng.uniform(1.5, 4.0))
    rise = np.log(fastest_hz / slowest_hz) / knots_s[-1]
    turns = slowest_hz * np.expm1(rise * knots_s) / rise
    return _driven(knots_s, rng.uniform(40.0, 100.0) * np.sin(2.0 * np.pi * turns))


def slow(rng: Generator, duration_s: float) -> Program:
    """Long ramps through zero that stay below a level."""
    knots_s = _knots(rng, duration_s, 1.2, 4.0)
    signs = np.where(np.arange(knots_s.size) % 2, 1.0, -1.0) * (1.0 if rng.random() < 0.5 else -1.0)
    duty = signs * rng.uniform(12.0, 60.0, knots_s.size)
    duty[0] = 0.0
    return _driven(knots_s, duty, ramped=True)


def saturated(rng: Generator, duration_s: float) -> Program:
    """Full power to and fro, with pauses."""
    knots_s = _knots(rng, duration_s, 0.2, 1.3)
    duty = rng.choice((-100.0, 100.0, 100.0, -100.0, 0.0), knots_s.size)
    return _driven(knots_s, duty)


def coasting(rng: Generator, duration_s: float) -> Program:
    """Spun up, then left to coast, braked, or driven with an open off phase."""
    knots_s = _knots(rng, duration_s, 0.4, 1.4)
    duty = rng.uniform(30.0, 100.0, knots_s.size) * rng.choice((-1.0, 1.0), knots_s.size)
    kind = np.where(
        np.arange(knots_s.size) % 2, DRIVE, rng.choice((COAST, COAST, FLOAT, BRAKE), knots_s.size)
    )
    duty[(kind == COAST) | (kind == BRAKE)] = 0.0
    return Played(knots_s, duty, kind.astype(np.int64), ramped=False)


def angle_loop(rng: Generator, duration_s: float) -> Program:
    """Goals of up to two turns, held for a while."""
    knots_s = _knots(rng, duration_s, 0.6, 2.2)
    goals_deg = rng.uniform(-1.0, 1.0, knots_s.size) * rng.choice((60.0, 180.0, 540.0), knots_s.size)
    goals_deg[0] = 0.0
    return AngleLoop(knots_s, goals_deg, float(rng.uniform(0.4, 1.2)), float(rng.uniform(0.02, 0.06)))


def speed_loop(rng: Generator, duration_s: float) -> Program:
    """Set speeds, some slow enough to stick."""
    knots_s = _knots(rng, duration_s, 0.8, 3.0)
    goals_dps = rng.uniform(-1.0, 1.0, knots_s.size) * rng.choice((90.0, 400.0, 700.0), knots_s.size)
    goals_dps[0] = 0.0
    return SpeedLoop(knots_s, goals_dps, float(rng.uniform(0.03, 0.08)), float(rng.uniform(0.2, 0.6)))


PROGRAMS: Final = {
    "by_hand": by_hand,
    "random_steps": random_steps,
    "one_step": one_step,
    "stairs": stairs,
    "wave": wave,
    "slow": slow,
    "saturated": saturated,
    "coasting": coasting,
    "angle_loop": angle_loop,
    "speed_loop": speed_loop,
}
FIRST_PROGRAMS: Final = tuple(name for name in PROGRAMS if name not in ("one_step", "stairs", "wave"))
"""Without the three that came later: sets that were scored before them stay as they were."""

FULL: Final = ("random_steps", "saturated", "by_hand")
"""One of these is in every case: without full power half of the motor's physics does not show."""


def draw_programs(
    rng: Generator, recordings: int, *, coasts: bool, among: Sequence[str] = tuple(PROGRAMS)
) -> tuple[str, ...]:
    """A different program for each recording, and again from the start after all `among`."""
    first = [str(rng.choice(FULL))] + (["coasting"] if coasts else [])
    if coasts and recordings == 1:
        return ("coasting",)
    others = [name for name in among if name not in first]
    order = [*first, *(str(name) for name in rng.permutation(others))]
    return tuple(order[k % len(order)] for k in range(recordings))
