"""How old held readings are: repeats tell when a reading came first, and a device's clock tells it to less."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.fitting.held import JUMP_STEPS, are_held
from nxt_twin.physics.signals import Signals

_ODD = 0.5  # of the middle time between refreshments: further off, a stall or a slow motor lies between
_SUREST = 1.0  # polls that an age is open at least: a host may fetch a poll late, and repeats share one error
_STRETCH = 20.0  # refreshments without a change, after which their number is in doubt
_FEWEST_CHANGES = 8  # of a stretch, from which a clock is told
_MOST_CHANGES = 40  # of a stretch: over more, a period has to be known to less than is tried
_PERIODS = 1.0 + np.linspace(-0.03, 0.03, 241)  # of a clock that are tried, in times of the mean period


def with_ages(recordings: Sequence[Signals]) -> list[Signals]:
    """The recordings, with how old their readings are where these are held; as they are where none is.

    A reading that repeats tells when it came first. It was taken since the reading before that.
    """
    if not are_held(recordings):
        return list(recordings)
    refreshed_s = _refreshed_s(recordings)
    if refreshed_s <= 0.0:
        return list(recordings)
    return [
        replace(one, ages=np.hstack([_ages(one, refreshed_s), one.ages[:, 2:]]), refreshed_s=refreshed_s)
        for one in recordings
    ]


def _refreshed_s(recordings: Sequence[Signals]) -> float:
    """The time from one refreshment of the readings to the next, s, as a quick motor shows it; 0 where none does."""
    times_s = np.concatenate([_between_jumps_s(one) for one in recordings])
    if not times_s.size:
        return 0.0
    middle_s = float(np.median(times_s))
    poll_s = float(np.median([one.interval_s for one in recordings]))  # each end is seen up to a poll late
    return float(np.mean(times_s[np.abs(times_s - middle_s) < _ODD * middle_s + poll_s]))


def _between_jumps_s(signals: Signals) -> FloatArray:
    """The times from one reading to the next other one, where both differ by a jump from those before."""
    rows = np.flatnonzero(np.isfinite(signals.measured))
    moved = np.abs(np.diff(signals.measured[rows]))
    changes = np.flatnonzero(moved > 0.0)
    jumps = moved[changes] > JUMP_STEPS * signals.quantum
    return np.asarray(np.diff(signals.time_s[rows][changes + 1])[jumps[1:] & jumps[:-1]])


def _ages(signals: Signals, refreshed_s: float) -> FloatArray:
    """As the first two of `Signals.ages`: since a reading came first, and from the reading before that until then.

    A device refreshes by its clock. Where one phase and period suit a stretch of readings, they tell both to less.
    """
    found = np.full((signals.time_s.size, 2), -1.0)
    rows = np.flatnonzero(np.isfinite(signals.measured))
    stamps_s = signals.time_s[rows]
    fresh = np.diff(signals.measured[rows], prepend=np.nan) != 0.0
    first = np.maximum.accumulate(np.where(fresh, np.arange(rows.size), 0))
    known = first > 0  # when the first reading of all was taken, none tells
    unseen_s = np.minimum((stamps_s[first] - stamps_s[first - 1])[known], refreshed_s)
    shown_s = np.minimum((stamps_s - stamps_s[first])[known], refreshed_s - unseen_s)
    found[rows[known]] = np.column_stack([shown_s, unseen_s])
    changes = np.flatnonzero(fresh)[1:]
    gaps = np.flatnonzero(np.diff(stamps_s[changes]) > _STRETCH * refreshed_s) + 1
    short = [part for stretch in np.split(changes, gaps) for part in _short(stretch)]
    for stretch in short:
        clock = _clock(stamps_s[stretch - 1], stamps_s[stretch], refreshed_s)
        if clock is not None:
            inside = np.arange(stretch[0], stretch[-1] + 1)
            change = np.searchsorted(stretch, inside, side="right") - 1
            found[rows[inside]] = clock.ages(stamps_s[inside], change, _SUREST * signals.interval_s)
    return found


def _short(changes: IntArray) -> list[IntArray]:
    """A stretch in parts in which no clock drifts, each as long as the others."""
    return np.array_split(changes, max(-(-changes.size // _MOST_CHANGES), 1))


@final
@dataclass(frozen=True)
class _Clock:
    """When a device refreshes.

    Attributes:
        least_s, open_s: the first refreshment, s, at the earliest, and how far it is open.
        period_s: from one to the next.
        passed: how many periods after it each change of the readings was, shape (changes,).
    """

    least_s: float
    open_s: float
    period_s: float
    passed: FloatArray

    def ages(self, stamps_s: FloatArray, change: IntArray, surest_s: float) -> FloatArray:
        """As the first two of `Signals.ages`, of readings at `stamps_s`, the last change before which was `change`.

        None is open by less than `surest_s`.
        """
        since_s = stamps_s - self.least_s - 0.5 * self.open_s - self.period_s * self.passed[change]
        later = since_s > self.period_s + self.open_s  # refreshed since then, with the reading as it was
        since_s = np.where(later, since_s % self.period_s, since_s)
        open_s = max(self.open_s, surest_s)
        shown_s = np.maximum(since_s - 0.5 * open_s, 0.0)
        return np.column_stack([shown_s, np.full(stamps_s.size, open_s)])


def _clock(before_s: FloatArray, after_s: FloatArray, refreshed_s: float) -> _Clock | None:
    """The clock of a device whose readings changed between these stamps, shape (changes,); None where none suits."""
    if after_s.size < _FEWEST_CHANGES:
        return None
    middle_s = 0.5 * (before_s + after_s)
    passed = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(np.diff(middle_s) / refreshed_s), 1.0))])
    best: _Clock | None = None
    for period_s in refreshed_s * _PERIODS:
        least_s = float(np.max(before_s - passed * period_s))
        open_s = float(np.min(after_s - passed * period_s)) - least_s
        if open_s > (best.open_s if best else 0.0):
            best = _Clock(least_s, open_s, float(period_s), passed)
    return best
