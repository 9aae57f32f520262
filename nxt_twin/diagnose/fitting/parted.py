"""Which whole recordings of a case are held out, where it names none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from nxt_twin.physics.modes import MODE_COAST, MODE_FLOAT
from nxt_twin.physics.signals import Signals

FEWEST_PARTED: Final = 3
"""Recordings, of which a whole one is held out."""
_BRIEF_S = 0.5  # s: for less, a mode of the drive tells nothing that no other mode does
_RUN_OUTS = (MODE_COAST, MODE_FLOAT)


def parted(signals: Sequence[Signals], *, second: bool = False) -> tuple[list[Signals], list[Signals]]:
    """The recordings to fit, and those to hold out: of each three one; of one or two none.

    The third of each three is held out, unless it alone lets the motor run out. Driven motion hardly tells friction
    from the braking of the motor's own voltage: what no fitted recording shows, no fit can predict. The one before it
    is held out then, or the first. With `second`, the next choice is taken.
    """
    if len(signals) < FEWEST_PARTED:
        return list(signals), []
    choices = [_without(signals, place) for place in (2, 1, 0)]
    choices.sort(key=lambda choice: _alone_s(*choice) >= _BRIEF_S)
    return choices[1 if second else 0]


def run_outs_s(fitted: Sequence[Signals], held_out: Signals) -> Mapping[int, float]:
    """For how long `held_out` is without current, or on a floating bridge, where no fitted recording is, by mode, s.

    Empty where it is for less than half a second.
    """
    known = {mode for one in fitted for mode in _modes_s(one)}
    lasts_s = _modes_s(held_out)
    alone = {mode: lasts_s[mode] for mode in _RUN_OUTS if mode in lasts_s.keys() - known}
    return alone if sum(alone.values()) >= _BRIEF_S else {}


def _without(signals: Sequence[Signals], place: int) -> tuple[list[Signals], list[Signals]]:
    fitted = [each for number, each in enumerate(signals) if number % FEWEST_PARTED != place]
    return fitted, list(signals[place::FEWEST_PARTED])


def _alone_s(fitted: Sequence[Signals], held_out: Sequence[Signals]) -> float:
    return sum(sum(run_outs_s(fitted, each).values()) for each in held_out)


def _modes_s(signals: Signals) -> dict[int, float]:
    """For how long each drive mode is in force while readings are taken, s."""
    ends_s = np.append(signals.command_time_s[1:], np.inf)
    first_s, last_s = signals.time_s[0], signals.time_s[-1]
    lasts_s = np.clip(ends_s, first_s, last_s) - np.clip(signals.command_time_s, first_s, last_s)
    return {
        mode: float(lasts_s[signals.command_mode == mode].sum())
        for mode in np.unique(signals.command_mode).tolist()
    }
