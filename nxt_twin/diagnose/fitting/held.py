"""Whether readings are held: they repeat, and then jump, while the motor turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.signals import Signals

_JUMP_STEPS = (
    2.5  # of the encoder: a motor that turns at this or less may well repeat a reading between two steps
)
_ODD = 0.5  # of the middle time between refreshments: further off, a stall or a slow motor lies between
_FEWEST_JUMPS = 30  # of a side: fewer do not tell whether readings are held
HELD_SHARE = 0.4
"""Of jumps by three steps or more: how many follow a repeated reading where readings are held.

On seeds 870 to 874 it is at most 0.1 of a side with 30 such jumps. Where readings are held for twice their interval or
more, it is 0.78 and more; of stale readings, a fourth of all, it is a third."""


def are_held(recordings: Sequence[Signals]) -> bool:
    """Whether the readings of these recordings are held for two of their intervals or so, or longer.

    A late command moves every reading alike, and none repeats while the motor turns.
    """
    counts = [_jumps(one) for one in recordings]
    after_repeats, jumps = (sum(each) for each in zip(*counts, strict=True))
    return bool(jumps >= _FEWEST_JUMPS and after_repeats > HELD_SHARE * jumps)


def hold_came_in(before: Sequence[Signals], after: Sequence[Signals]) -> bool:
    """Whether readings are held after and were not before."""
    return are_held(after) and not are_held(before)


def with_ages(recordings: Sequence[Signals]) -> list[Signals]:
    """The recordings, with how old their readings are where these are held; as they are where none is.

    A reading that repeats tells when it came first. It was taken since the reading before that.
    """
    if not are_held(recordings):
        return list(recordings)
    refreshed_s = _refreshed_s(recordings)
    if refreshed_s <= 0.0:
        return list(recordings)
    return [replace(one, ages=_ages(one, refreshed_s), refreshed_s=refreshed_s) for one in recordings]


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
    jumps = moved[changes] > _JUMP_STEPS * signals.quantum
    return np.asarray(np.diff(signals.time_s[rows][changes + 1])[jumps[1:] & jumps[:-1]])


def _ages(signals: Signals, refreshed_s: float) -> FloatArray:
    """As `Signals.ages`: since a reading came first, and from the reading before that until then."""
    found = np.full((signals.time_s.size, 2), -1.0)
    rows = np.flatnonzero(np.isfinite(signals.measured))
    stamps_s = signals.time_s[rows]
    fresh = np.diff(signals.measured[rows], prepend=np.nan) != 0.0
    first = np.maximum.accumulate(np.where(fresh, np.arange(rows.size), 0))
    known = first > 0  # when the first reading of all was taken, none tells
    unseen_s = np.minimum((stamps_s[first] - stamps_s[first - 1])[known], refreshed_s)
    shown_s = np.minimum((stamps_s - stamps_s[first])[known], refreshed_s - unseen_s)
    found[rows[known]] = np.column_stack([shown_s, unseen_s])
    return found


def _jumps(signals: Signals) -> tuple[int, int]:
    """How many jumps follow a repeated reading, and how many there are."""
    moved = np.abs(np.diff(signals.measured[np.isfinite(signals.measured)]))
    jump = moved[1:] > _JUMP_STEPS * signals.quantum
    return int((jump & (moved[:-1] == 0.0)).sum()), int(jump.sum())
