"""Where a run takes its state from outside: once at rest, or again and again from smoothed readings."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.physics.beginning import begins_at_rest, goes_off_at_once
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.smooth import half_window_s, smoothed

_BEFORE_S = 1.0
RUN_IN_S = 0.3
RUN_IN_READINGS = 8


@final
@dataclass(frozen=True)
class Start:
    """At which samples a run starts anew, always including the first, and from where.

    Attributes:
        at: whether it does, shape (samples,).
        position, speed: as the encoder would show them, shape (samples,).
        states: current and extra states of the effects at each start, in the kernel's order, shape (starts, states).
            Empty if they are unknown; then all but the motor begins at rest.
    """

    at: BoolArray
    position: FloatArray
    speed: FloatArray
    states: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    def part(self, rows: IntArray) -> Start:
        """The same for some of the samples."""
        begun = np.cumsum(self.at)[rows][self.at[rows]] - 1
        states = self.states[begun] if self.states.size else self.states
        return Start(self.at[rows], self.position[rows], self.speed[rows], states)


def at_rest(signals: Signals) -> Start:
    """Start once, at the first reading, standing still; at 0 where nothing was read."""
    rows = signals.time_s.size
    read = signals.measured[np.isfinite(signals.measured)]
    first = read[0] if read.size else 0.0
    at = np.zeros(rows, dtype=bool)
    at[0] = True
    return Start(
        at, np.full(rows, 0.0 if signals.is_speed else first), np.full(rows, first * signals.is_speed)
    )


def restarts(signals: Signals, every_s: float) -> Start:
    """Start anew from the smoothed readings every `every_s` seconds, beginning with the first.

    Where a recording begins at rest, so does the run.
    """
    position, speed = smoothed(signals)
    if begins_at_rest(signals):
        position[0], speed[0] = signals.measured[0], 0.0
    window = np.floor((signals.time_s - signals.time_s[0]) / every_s)
    at = np.diff(window, prepend=-1.0) > 0.0
    at &= np.isfinite(signals.measured) | (np.arange(at.size) == 0)
    resolved = np.abs(speed) >= _speed_resolution(signals)
    return Start(at, position, np.where(resolved, speed, 0.0))


def moving_start(signals: Signals) -> Start:
    """Start once, at the first reading, with the speed that the first readings show."""
    return restarts(signals, np.inf)


def driven_before(signals: Signals) -> Signals:
    """The first command in force for a while before the first row, where the machine moves there or goes off at once.

    A command that acts late would else leave it without any at first.
    """
    moves = moving_start(signals).speed[0] != 0.0 or goes_off_at_once(signals)
    if not moves or signals.command_time_s[0] > signals.time_s[0]:
        return signals
    since_s = np.array(signals.command_time_s)
    since_s[0] -= _BEFORE_S
    return replace(signals, command_time_s=since_s)


def run_in(signals: Signals) -> BoolArray:
    """Which of the first samples a corrected run needs to learn how fast the machine was at the first one.

    None where a recording begins at rest, as far as its readings tell.
    """
    if moving_start(signals).speed[0] == 0.0:
        return np.zeros(signals.time_s.size, dtype=bool)
    spell_s = max(RUN_IN_S, RUN_IN_READINGS * signals.interval_s)
    return np.asarray(signals.time_s - signals.time_s[0] < spell_s)


def windows(signals: Signals, every_s: float) -> BoolArray:
    """At which samples windows of `every_s` begin, the first of them anew after the run-in."""
    unknown = run_in(signals)
    number = np.floor((signals.time_s - signals.time_s[0]) / every_s) - unknown
    at = np.diff(number, prepend=-np.inf) > 0.0
    at &= np.isfinite(signals.measured) & ~unknown
    at[0] = True
    return np.asarray(at)


def _speed_resolution(signals: Signals) -> float:
    """The smallest speed that the quantum lets the smoother see."""
    return 0.0 if signals.is_speed else signals.quantum / half_window_s(signals)
