"""Rows that a link handed over in clumps, at the moments at which they were read: their stamps tell when they came."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.arrays import BoolArray, IntArray
from nxt_twin.physics.signals import Signals
from nxt_twin.recording.clumps import clump_ends, when_read

_AT_ONCE: Final = 0.5
"""How far readings move within a clump, over how far they move from one to the next, below which they were polled at
once. Rows that were read evenly have 1, rows that were polled in a burst none."""

_READ: Final = 0.9
"""Share of the rows that hold a reading: where topics or motors have rows of their own, those come at once as well."""

_BY_CLUMPS: Final = 0.9
"""Share of the commands that change in the first row of a clump, from which a host gave them as that clump came."""


def as_read(signals: Signals) -> Signals:
    """The signals with the rows of each clump spread evenly since the one before; as they are where none came so.

    A host that got a clump gave its command then, so that it stays where it was stamped. Commands that change within
    clumps came with their rows, and move with them. Where a clump waited, only its last reading has a known moment: the
    others are left out.
    """
    ends = clump_ends(signals.time_s)
    mostly_read = np.mean(np.isfinite(signals.measured)) > _READ
    if not ends.size or not mostly_read or _were_polled_at_once(signals, ends):
        return signals
    read = when_read(signals.time_s, ends, signals.measured, signals.quantum)
    found = replace(
        signals,
        time_s=read.time_s,
        measured=np.where(read.known, signals.measured, np.nan),
        clump_rows=signals.time_s.size / ends.size,
        open_s=read.open_s,
    )
    row = np.clip(np.searchsorted(signals.time_s, signals.command_time_s), 0, signals.time_s.size - 1)
    if _came_by_clumps(signals, ends, row):
        return found
    after_s = signals.command_time_s - signals.time_s[row]
    return replace(found, command_time_s=read.time_s[row] + after_s, command_open_s=read.open_s[row])


def _firsts(rows: int, ends: IntArray) -> BoolArray:
    """Which of the rows is the first of its clump."""
    first = np.zeros(rows, dtype=bool)
    first[np.append(0, ends[:-1] + 1)] = True
    return first


def _were_polled_at_once(signals: Signals, ends: IntArray) -> bool:
    """Whether readings stand still within a clump, and move from one to the next."""
    read = np.flatnonzero(np.isfinite(signals.measured))
    moved = np.abs(np.diff(signals.measured[read]))
    across = np.diff(np.cumsum(_firsts(signals.time_s.size, ends))[read]) > 0
    if not across.any() or across.all() or not moved.any():
        return False
    return bool(np.mean(moved[~across]) < _AT_ONCE * np.mean(moved[across]))


def _came_by_clumps(signals: Signals, ends: IntArray, row: IntArray) -> bool:
    """Whether a host gave its commands as clumps came; `row` is that of each command, shape (commands,)."""
    own = np.column_stack([signals.command, signals.command_mode])
    changed = np.flatnonzero(np.any(np.diff(own, axis=0) != 0.0, axis=1)) + 1
    by_clumps = _firsts(signals.time_s.size, ends)[row[changed]]
    return not changed.size or bool(np.mean(by_clumps) >= _BY_CLUMPS)
