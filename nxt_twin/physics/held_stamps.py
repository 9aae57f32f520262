"""Stamps of a clock that stepped back: a logger holds them until it has caught up, and they tell no moment."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.physics.signals import Signals

_HELD: Final = 0.1  # of the usual time from one reading to the next: no host polls so soon again
_FEW: Final = 0.05  # share of the readings: where more come so, they come in clumps


def without_held_stamps(signals: Signals) -> Signals:
    """The signals less the few readings that are stamped hardly later than the one before; it is told when they were.

    A clock that leaps back in a regular course tells its period by them.
    """
    read = np.flatnonzero(np.isfinite(signals.measured))
    if signals.clump_rows or read.size < 2:
        return signals
    held = np.append(False, np.diff(signals.time_s[read]) < _HELD * signals.interval_s)
    if not held.any() or held.sum() > _FEW * read.size:
        return signals
    beside = np.append(held[1:], False) | np.append(False, held[:-1])
    measured = signals.measured.copy()
    measured[read[held | beside]] = np.nan
    first = held & ~np.append(False, held[:-1])
    began_s = signals.time_s[read[first]] - signals.time_s[0]
    rows = np.bincount(np.cumsum(first)[held] - 1)
    return replace(signals, measured=measured, held_s=np.column_stack([began_s, rows * signals.interval_s]))
