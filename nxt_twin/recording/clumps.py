"""Rows that a link hands over in clumps: their stamps tell when they came, and not when they were read."""

from __future__ import annotations

from typing import Final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray

_AT_ONCE: Final = 0.2  # of the usual time from row to row, below which a row came with the one before it
_MOSTLY: Final = 0.4  # share of the rows that come so where a link clumps them: pairs have a half
_ALONE: Final = (
    0.5  # of all clumps, those of one row, above which rows waited for a late one, and no link clumps
)
_APART: Final = 32  # rows over which the usual time is told whatever the clumps
_NEXT_S: Final = 1e-6  # from one row of a clump to the next, where they have one stamp
_LONGEST: Final = 1.5  # of the usual time between rows, beyond which a clump waited for the link or the host


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


def read_s(time_s: FloatArray, ends: IntArray) -> tuple[FloatArray, BoolArray]:
    """When the rows of clumps were read, s: the last one as it came, the others evenly since the clump before.

    Args:
        time_s: stamps, shape (rows,).
        ends: as `clump_ends` has them.

    Returns:
        The moments, and which of them are known: where a clump was long in coming, only its last row's is.
    """
    sizes = np.diff(ends, prepend=-1)
    since_s = np.diff(time_s[ends]) / sizes[1:]
    usual = float(np.median(since_s))
    apart_s = np.append(usual, since_s)
    rows, clump = np.arange(time_s.size), np.repeat(np.arange(ends.size), sizes)
    moments_s = (
        time_s[ends][clump]
        - (ends[clump] - rows) * np.where(apart_s <= _LONGEST * usual, apart_s, usual)[clump]
    )
    return moments_s, (apart_s <= _LONGEST * usual)[clump] | (rows == ends[clump])
