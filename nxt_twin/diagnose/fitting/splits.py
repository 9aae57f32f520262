"""Which readings are fitted, which only check a choice, and which are held out for the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, IntArray
from nxt_twin.physics.signals import Signals

WINDOW_S = 2.0
"""Length of the simulated windows on which models are judged; a longer one rewards lucky drift of an integrator."""

_CYCLE = 6  # windows of a recording: fit, fit, held out, fit, check, held out
_HELD_OUT = (2, 5)
_CHECK = 4  # the window of a cycle that checks
_CHECKS = 4  # one block of four checks a choice
_LONGEST_BLOCK_S = 2.0  # that checks
_SHORTEST_BLOCK_S = 0.5  # that checks
_BLOCKS = 16  # of the shortest recording, at least


@final
@dataclass(frozen=True)
class Split:
    """Which samples of one recording are held out and which check; shape (samples,). All others are fitted."""

    held_out: BoolArray
    check: BoolArray


def with_windows_held_out(recordings: Sequence[Signals]) -> tuple[list[Split], float]:
    """Hold windows of time out of each recording; the windows' length comes with it, s.

    A window is short enough for each recording to have all three kinds of them.
    """
    window_s = min(WINDOW_S, min(length_s(signals) for signals in recordings) / _CYCLE)
    splits = []
    for signals in recordings:
        role = _in_time(signals, window_s, 0.0) % _CYCLE
        if not _all_read(signals, role):
            role = _in_order(signals, _CYCLE)
        splits.append(Split(np.isin(role, _HELD_OUT), role == _CHECK))
    return splits, window_s


def with_blocks_that_check(recordings: Sequence[Signals]) -> list[Split]:
    """Hold nothing out of `recordings`; each fourth block of time checks.

    No whole recording does: what is put on in that one would be seen by no fit.
    """
    nothing = [np.zeros(signals.time_s.size, dtype=bool) for signals in recordings]
    shortest_s = min(length_s(signals) for signals in recordings)
    block_s = min(_LONGEST_BLOCK_S, max(_SHORTEST_BLOCK_S, shortest_s / _BLOCKS))
    splits, begins_s = [], 0.0
    for signals, none in zip(recordings, nothing, strict=True):
        check = _in_time(signals, block_s, begins_s) % _CHECKS == _CHECKS - 1
        begins_s += length_s(signals)
        splits.append(Split(none, check))
    read = [np.isfinite(signals.measured) for signals in recordings]
    checked = [(split.check & known).any() for split, known in zip(splits, read, strict=True)]
    if any(checked):
        return splits
    return [
        Split(none, _in_order(signals, _CHECKS) == _CHECKS - 1)
        for signals, none in zip(recordings, nothing, strict=True)
    ]


def length_s(signals: Signals) -> float:
    """From the first sample to the last, s."""
    return float(signals.time_s[-1] - signals.time_s[0])


def _in_time(signals: Signals, every_s: float, begins_s: float) -> IntArray:
    """The number of the stretch of time that each sample lies in."""
    elapsed_s = signals.time_s - signals.time_s[0] + begins_s
    return np.asarray(np.floor(elapsed_s / every_s).astype(int))


def _in_order(signals: Signals, parts: int) -> IntArray:
    """Each sample's part of as many, with as many readings each: where stretches of time may have none."""
    read = np.cumsum(np.isfinite(signals.measured)) - 1
    return np.asarray(np.maximum(read, 0) * parts // max(int(read[-1]) + 1, 1))


def _all_read(signals: Signals, role: IntArray) -> bool:
    """Whether each role of a cycle has readings."""
    read = role[np.isfinite(signals.measured)]
    return bool(np.isin(range(_CYCLE), read).all())
