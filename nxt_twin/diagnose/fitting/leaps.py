"""Readings that leap away and back faster than anything moves: a driver put them there, in place of lost ones."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.physics.signals import Signals

_MOST_IN_A_ROW: Final = 3  # readings that leap together
_MOST_SHARE: Final = 0.02  # of all readings
_LARGER: Final = 3.0  # times the largest other step of the recording, by which each leap has to exceed it
_LEAST_QUANTA: Final = 10.0  # as above, in steps of the encoder
_TOGETHER: Final = 0.5  # of the smaller leap: so far apart may readings be that leap together


@final
class _Leaps:
    """Groups of readings between two opposite steps, the largest first.

    Attributes:
        first: the number of each group's first reading, shape (groups,).
        count: how many readings it has, shape (groups,).
        size: the smaller of both steps, shape (groups,).
    """

    def __init__(self, angle: FloatArray) -> None:
        steps = np.diff(angle)
        found = [_groups(steps, count) for count in range(1, _MOST_IN_A_ROW + 1) if steps.size > count]
        first, count, size = (np.concatenate(column) for column in zip(*found, strict=True))
        order = np.argsort(-size, kind="stable")
        self.first, self.count, self.size = first[order], count[order], size[order]


def leaps(signals: Signals) -> BoolArray:
    """Which readings leap away from those before them and back, shape (samples,).

    Each of both leaps is three times as large as every other step of the recording, and ten steps of the encoder. So a
    motor that turns, a stall of the link and an angle that wraps at half a turn are none.
    """
    read = np.flatnonzero(np.isfinite(signals.measured))
    found = np.zeros(signals.measured.size, dtype=bool)
    if read.size <= _MOST_IN_A_ROW + 1:
        return found
    angle = signals.measured[read]
    groups = _Leaps(angle)
    for number in range(_leaping(groups, np.abs(np.diff(angle)), signals.quantum)):
        first = groups.first[number]
        found[read[first : first + groups.count[number]]] = True
    return found


def without_leaps(signals: Signals) -> Signals:
    """`signals` without the readings that `leaps` finds."""
    found = leaps(signals)
    return replace(signals, measured=np.where(found, np.nan, signals.measured)) if found.any() else signals


def _groups(steps: FloatArray, count: int) -> tuple[IntArray, IntArray, FloatArray]:
    """Groups of `count` readings that lie apart from those to both sides, as `_Leaps` has them."""
    out, back = steps[:-count], steps[count:]
    size = np.minimum(np.abs(out), np.abs(back))
    apart = np.sign(out) * np.sign(back) < 0.0
    for inner in range(1, count):
        apart &= np.abs(steps[inner : inner + out.size]) <= _TOGETHER * size
    first = np.flatnonzero(apart) + 1
    return first, np.full_like(first, count), size[apart]


def _leaping(groups: _Leaps, steps: FloatArray, quantum: float) -> int:
    """How many of `groups`, the largest first, leap by enough beside the largest of all other `steps`."""
    order = np.argsort(-steps, kind="stable")
    used = np.zeros(steps.size, dtype=bool)
    rest = leaping = 0
    for number in range(min(groups.size.size, 1 + int(_MOST_SHARE * steps.size))):
        used[[groups.first[number] - 1, groups.first[number] + groups.count[number] - 1]] = True
        while rest < order.size and used[order[rest]]:
            rest += 1
        other = float(steps[order[rest]]) if rest < order.size else 0.0
        if groups.size[number] > max(_LARGER * other, _LEAST_QUANTA * quantum):
            leaping = number + 1
    return leaping
