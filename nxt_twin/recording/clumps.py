"""Rows that a link hands over in clumps: their stamps tell when they came, and not when they were read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.recording.clump_course import even_course

_AT_ONCE: Final = 0.2  # of the usual time from row to row, below which a row came with the one before it
_MOSTLY: Final = 0.4  # share of the rows that come so where a link clumps them: pairs have a half
_ALONE: Final = (
    0.5  # of all clumps, those of one row, above which rows waited for a late one, and no link clumps
)
_APART: Final = 32  # rows over which the usual time is told whatever the clumps
_BY_FAR: Final = 3.0  # times the next longest step of a clump's readings, at a wait of the host
_NEXT_S: Final = 1e-6  # from one row of a clump to the next, where they have one stamp


def usual_s(time_s: FloatArray) -> float:
    """The usual time from one row to the next, s, also of rows that came in clumps."""
    if time_s.size < 2:
        return 0.0
    apart = min(_APART, time_s.size - 1)
    return float(np.median(time_s[apart:] - time_s[:-apart])) / apart


def clump_ends(time_s: FloatArray) -> IntArray:
    """The last row of each clump; none where rows come one by one."""
    at_once = came_at_once(time_s)
    ends = np.append(np.flatnonzero(~at_once), time_s.size - 1)
    alone = np.diff(ends, prepend=-1) == 1
    if time_s.size <= _APART or np.mean(at_once) < _MOSTLY or np.mean(alone) > _ALONE:
        return np.zeros(0, dtype=np.int64)
    return ends


def came_at_once(time_s: FloatArray) -> BoolArray:
    """Which rows but the first came with the one before them, shape (rows - 1,)."""
    return np.asarray(np.diff(time_s) < _AT_ONCE * usual_s(time_s))


def told_apart_s(time_s: FloatArray) -> FloatArray:
    """Stamps, those of rows that share one a microsecond apart, so that each row keeps its command."""
    waits_s = np.diff(time_s)
    if not waits_s.any() or waits_s.all():
        return time_s
    rows = np.arange(time_s.size)
    first = np.maximum.accumulate(np.where(np.diff(time_s, prepend=-np.inf) > 0.0, rows, 0))
    return np.asarray(time_s + _NEXT_S * (rows - first))


@final
@dataclass(frozen=True)
class Read:
    """When rows of clumps were read.

    Attributes:
        time_s: the moments, shape (rows,).
        open_s: how far they are open, standard deviations, shape (rows,).
        known: which of them are known at all: where a clump was long in coming, its last row's is at most.
    """

    time_s: FloatArray
    open_s: FloatArray
    known: BoolArray


def when_read(time_s: FloatArray, ends: IntArray, measured: FloatArray, quantum: float) -> Read:
    """When the rows of clumps were read: the last ones on an even course, the others evenly since the clump before.

    Between two last rows the others are open as a random walk is that begins and ends where it is known. Where a clump
    was long in coming, the wait lies before the reading that moves by far the most. Without one it lies before all.

    Args:
        time_s: stamps, shape (rows,).
        ends: as `clump_ends` has them.
        measured: the readings, shape (rows,).
        quantum: their smallest step.
    """
    sizes = np.diff(ends, prepend=-1)
    course = even_course(time_s[ends], sizes, usual_s(time_s))
    rows, clump = np.arange(time_s.size), np.repeat(np.arange(ends.size), sizes)
    apart_s = np.diff(course.read_s, prepend=-np.inf) / sizes
    before_end, size = ends[clump] - rows, sizes[clump]
    each_s = np.where(course.stalled | ~np.isfinite(apart_s), course.row_s, apart_s)
    moments_s = course.read_s[clump] - before_end * each_s[clump]
    known = ~course.stalled[clump] | (before_end == 0)
    for waiting in np.flatnonzero(course.stalled):
        early = _before_wait(measured, quantum, int(ends[waiting - 1]), int(ends[waiting]))
        after_s = course.row_s * (early - ends[waiting - 1])
        moments_s[early] = np.minimum(course.read_s[waiting - 1] + after_s, course.read_s[waiting])
        known[early] = False
    since = (size - before_end) / size
    ends_s2 = since * course.open_s2[clump] + (1.0 - since) * course.open_s2[np.maximum(clump - 1, 0)]
    return Read(
        told_apart_s(np.maximum.accumulate(moments_s)),
        np.sqrt(np.maximum(course.walk_s2 * since * before_end + ends_s2, 0.0)),
        known,
    )


def _before_wait(measured: FloatArray, quantum: float, end_before: int, end: int) -> IntArray:
    """The rows of a clump that were read before the wait, by the reading that moves by far the most; else none.

    A motor that is at rest tells no place, and its command came after the wait, as it would have moved in it. A timer
    may have sent the clump in the midst of the wait: then the next reading moves most. The last clump of a recording
    has fewer rows than others, and waited for nothing.
    """
    if end == measured.size - 1:
        return np.arange(end_before + 1, end + 1)
    moved = np.nan_to_num(np.abs(np.diff(measured[end_before : end + 2])))
    place = int(np.argmax(moved))
    others = np.delete(moved, place)
    clear = moved[place] > _BY_FAR * (float(np.max(others, initial=0.0)) + quantum)
    return np.arange(end_before + 1, end_before + 1 + (place if clear else 0))
