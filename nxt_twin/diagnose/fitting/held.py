"""Whether readings are held: they repeat, and then jump, while the motor turns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nxt_twin.physics.signals import Signals

JUMP_STEPS = (
    2.5  # of the encoder: a motor that turns at this or less may well repeat a reading between two steps
)
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


def _jumps(signals: Signals) -> tuple[int, int]:
    """How many jumps follow a repeated reading, and how many there are."""
    moved = np.abs(np.diff(signals.measured[np.isfinite(signals.measured)]))
    jump = moved[1:] > JUMP_STEPS * signals.quantum
    return int((jump & (moved[:-1] == 0.0)).sum()), int(jump.sum())
