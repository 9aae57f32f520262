"""By how much chance makes each row late: its stamp, against a smooth course of the stamps beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.random import Generator
from scipy.linalg import solveh_banded
from scipy.optimize import nnls

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.recording.clumps import came_at_once, clump_ends, told_apart_s, usual_s

_APART = (4, 8, 16, 32)
"""Rows over which stamps tell how late rows are, which stays, from the jitter of polls, which adds up."""

_FEWEST_ROWS = 2 * _APART[-1]  # of a recording that tells

_LATE_TURNS = -0.08
"""Correlation of neighbouring times between rows, above which no row is late.

It is -0.079 to 0.29 in 288 cases of Drake's simulator whose polls alone have jitter. Rounded stamps turn more."""

_WAITING = 0.02
"""Share of the rows that came with the one before them, from which rows wait for late ones.

A host's polls are hardly ever that close. In 1158 of 1167 recordings whose rows are not late by chance, of our families
and of a foreign simulator, it is at most 0.1 %. All others have clocks that wander."""

_TURNED = 0.5  # how far a motor turned between such rows, over how far between others: none, where polls come in bursts
_SURE = 3.0  # standard deviations of that correlation by chance, at least
_CLIPPED = 5.0  # deviations from the middle time between rows, up to which that correlation counts it
_STEADY = 0.05  # of a poll: no host is steadier, so that the course may bend
_PUNCTUAL = 0.3  # of a poll's jitter: where few rows are late, the others are punctual to this
_STALLS = 3.0  # degrees of freedom of a poll's jitter: stalls are rare and long
_SELDOM = 1.5  # degrees of freedom of a row's lateness: most rows may be punctual, and few of them very late
_ROUNDS = 30  # of weighing the stalls
_STALLED = 5  # of these go to stalls alone, so that no row after a stall is taken for late
_LAG_SPAN, _WAVES = Slot("clock_skew", "lag_span"), Slot("clock_skew", "waves")
_LEAST_SPAN_S = 2e-3  # rounded stamps seem late as well, by half a millisecond


def with_lateness(recordings: Sequence[Signals]) -> list[Signals]:
    """The recordings, with how late each row of theirs was stamped; as they are where no stamp tells that.

    A row that chance stamps late leaves a long time before it and a short one after it. A poll that is late itself puts
    off all that follow.
    """
    long = [one for one in recordings if one.time_s.size >= _FEWEST_ROWS]
    if not (long and (_turn(long) or _wait(long))):
        return list(recordings)
    late_s, jitter_s = _deviations(long)
    clocks = [_Polling(late_s, jitter_s, usual_s(one.time_s)) for one in recordings]
    known = [
        clock.lateness(one.time_s)
        for clock, one in zip(clocks, recordings, strict=True)
        if one.time_s.size >= _FEWEST_ROWS
    ]
    strays_s = math.hypot(float(np.std(np.concatenate(known))), clocks[0].open_s)
    span_s = math.sqrt(12.0) * strays_s  # of a lateness that is anywhere in it
    if span_s < _LEAST_SPAN_S:
        return list(recordings)
    return [_with(one, clock, span_s) for one, clock in zip(recordings, clocks, strict=True)]


def as_late_as(plant: Plant, signals: Signals) -> Signals:
    """The signals with how late each row was stamped, where `plant` has rows that are late by chance."""
    span_s = plant.values.get(_LAG_SPAN, 0.0)
    told = signals.time_s.size > _APART[-1] and not signals.clump_rows
    if plant.values.get(_WAVES, 1.0) > 0.0 or span_s <= 0.0 or not told:
        return signals
    late_s = span_s / math.sqrt(12.0)
    adding_up = (_variances([signals]) - 2.0 * late_s**2) / np.array(_APART)
    jitter_s = math.sqrt(max(float(np.median(adding_up)), 0.0))
    poll_s = usual_s(signals.time_s)
    return _with(signals, _Polling(late_s, max(jitter_s, _STEADY * poll_s), poll_s), span_s)


def with_drawn_moments(signals: Signals, rng: Generator) -> Signals:
    """The signals with each row read when chance may have had it read, as stamps leave that open, a command with it."""
    if signals.late_open <= 0.0:
        return _with_drawn_clumps(signals, rng)
    off = signals.late_open * rng.standard_normal(signals.time_s.size)
    row = np.clip(np.searchsorted(signals.time_s, signals.command_time_s), 0, off.size - 1)
    ages = signals.ages + off[:, None] * np.array([0.0, 0.0, 1.0, 0.0])
    return replace(signals, ages=ages, command_late=signals.command_late + off[row])


def _with_drawn_clumps(signals: Signals, rng: Generator) -> Signals:
    """As `with_drawn_moments`, of rows that came in clumps: none overtakes the row before it."""
    if not signals.open_s.any():
        return signals
    read_s, given_s = (
        np.maximum.accumulate(at_s + open_s * rng.standard_normal(at_s.size))
        for at_s, open_s in (
            (signals.time_s, signals.open_s),
            (signals.command_time_s, signals.command_open_s),
        )
    )
    return replace(signals, time_s=told_apart_s(read_s), command_time_s=given_s)


def _with(signals: Signals, clock: _Polling, span_s: float) -> Signals:
    late = clock.lateness(signals.time_s) / span_s
    late_open = clock.open_s / span_s
    return replace(
        signals,
        ages=np.column_stack([signals.ages[:, :2], late, np.full(late.size, late_open)]),
        late_span_s=span_s,
        late_open=late_open,
        command_late=np.interp(signals.command_time_s, signals.time_s, late),
    )


def _turn(recordings: Sequence[Signals]) -> bool:
    """Whether neighbouring times between rows surely go against each other."""
    rows = sum(one.time_s.size for one in recordings)
    return _turning(recordings) <= min(_LATE_TURNS, -_SURE / math.sqrt(rows))


def _wait(recordings: Sequence[Signals]) -> bool:
    """Whether rows came with the row before, though the motor had turned: they were read, and waited for a late one."""
    waited = [came_at_once(one.time_s) for one in recordings]
    if any(clump_ends(one.time_s).size for one in recordings) or np.mean(np.concatenate(waited)) < _WAITING:
        return False
    moved = np.concatenate([np.abs(np.diff(one.measured)) for one in recordings])
    at_once = np.concatenate(waited)
    late, punctual = (moved[own & np.isfinite(moved)] for own in (at_once, ~at_once))
    return bool(late.size and punctual.size and np.mean(late) > _TURNED * np.mean(punctual))


def _turning(recordings: Sequence[Signals]) -> float:
    """The correlation of neighbouring times between rows, stalls clipped."""
    pairs = []
    for one in recordings:
        off_s = np.diff(one.time_s) - np.median(np.diff(one.time_s))
        most_s = _CLIPPED * 1.4826 * float(np.median(np.abs(off_s))) + usual_s(one.time_s)
        clipped = np.clip(off_s, -most_s, most_s)
        pairs.append(np.column_stack([clipped[:-1], clipped[1:]]) - np.mean(clipped))
    before, after = np.concatenate(pairs).T
    return float(np.sum(before * after) / max(np.sqrt(np.sum(before**2) * np.sum(after**2)), 1e-30))


def _deviations(recordings: Sequence[Signals]) -> tuple[float, float]:
    """The deviations of a row's lateness and of the time from one poll to the next, s.

    Over m rows the variance of a difference of stamps is twice that of the lateness, and m times that of the polls.
    """
    variances = np.maximum(_variances(recordings), 1e-18)
    design = np.column_stack([np.full(len(_APART), 2.0), np.array(_APART, dtype=float)])
    (late, jitter), _ = nnls(design / variances[:, None], np.ones(len(_APART)))
    steady_s = _STEADY * float(np.median([usual_s(one.time_s) for one in recordings]))
    jitter_s = max(math.sqrt(jitter), steady_s)
    return max(math.sqrt(late), _PUNCTUAL * jitter_s), jitter_s


def _variances(recordings: Sequence[Signals]) -> FloatArray:
    """The variances of differences of stamps over each of `_APART` rows, robust, s², shape (numbers of rows,)."""
    found = []
    for apart in _APART:
        off_s = [one.time_s[apart:] - one.time_s[:-apart] for one in recordings]
        middle_s = np.concatenate([each - np.median(each) for each in off_s])
        found.append((1.4826 * float(np.median(np.abs(middle_s)))) ** 2)
    return np.array(found)


@final
@dataclass(frozen=True)
class _Polling:
    """How stamps come about: polls of one rate with jitter, each stamped late by chance.

    Attributes:
        late_s, jitter_s: deviations of the lateness, and of the time from one poll to the next.
        poll_s: that time's mean.
    """

    late_s: float
    jitter_s: float
    poll_s: float

    @property
    def open_s(self) -> float:
        """The deviation of a row's lateness from what `lateness` tells, far from either end of a recording, s."""
        return self.late_s / math.sqrt(math.hypot(1.0, 2.0 * self.late_s / self.jitter_s))

    def lateness(self, stamps_s: FloatArray) -> FloatArray:
        """By how much each row was stamped late, less a lateness that all share, s, shape (rows,)."""
        return np.asarray(stamps_s - self._course(stamps_s))

    def _course(self, stamps_s: FloatArray) -> FloatArray:
        """The likeliest moments of the polls, s, shape (rows,).

        A stall may make a time between polls long, and chance may make a row late. Nothing makes either short.
        """
        rows = stamps_s.size
        if rows < 2:
            return stamps_s
        bonds, own = np.ones(rows - 1), np.ones(rows)
        course = stamps_s
        for turn in range(_ROUNDS):
            bond, pull = bonds / self.jitter_s**2, own / self.late_s**2
            banded = np.zeros((2, rows))
            banded[0, 1:] = -bond
            banded[1] = pull
            banded[1, 1:] += bond
            banded[1, :-1] += bond
            target = stamps_s * pull
            target[1:] += bond * self.poll_s
            target[:-1] -= bond * self.poll_s
            course = solveh_banded(banded, target)
            bonds = _weights((np.diff(course) - self.poll_s) / self.jitter_s, _STALLS)
            if turn >= _STALLED:
                late = (stamps_s - course) / self.late_s
                own = _weights(late - np.median(late), _SELDOM)
        return course


def _weights(off: FloatArray, freedom: float) -> FloatArray:
    """Those of Student's t above the middle, and of a normal distribution below it."""
    return np.asarray((freedom + 1.0) / (freedom + np.square(np.maximum(off, 0.0))))
