"""The current that a brick's other motors draw from the shared battery, from their columns of a recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.modes import MODE_DRIVE, MODE_FLOAT
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.smooth import smoothed

_SPEED_RESOLUTION_RAD_S = 0.25  # a change of what is counted below it is not told anew


def with_others(signals: Signals, others: Sequence[Signals]) -> Signals:
    """The signals of a motor beside others on the same battery, each with its own stamps.

    A motor draws (share·U - Ke·duty·speed)/R at the supply U: its bridge connects the winding for |duty| of the time.
    The mean voltage is duty·U, or U while floating. Coasting and braking draw nothing. The signals hold the sums of
    share and of duty·speed, so that a fit may try U, Ke and R.
    """
    driven = [other for other in others if other.command.any()]
    if not driven:
        return signals
    stamps = np.unique(np.concatenate([signals.time_s, *(other.command_time_s for other in driven)]))
    load = np.sum([_load(other, stamps) for other in driven], axis=0)
    kept = np.ones(stamps.size, dtype=bool)
    speeds = np.round(load[:, 1] / _SPEED_RESOLUTION_RAD_S)
    kept[1:] = (np.diff(load[:, 0]) != 0.0) | (np.diff(speeds) != 0.0)
    return replace(signals, others_time_s=stamps[kept], others_load=load[kept])


def _load(other: Signals, stamps: FloatArray) -> FloatArray:
    """Share and duty·speed (rad/s) of one motor from each stamp until the next, shape (stamps, 2)."""
    held = np.searchsorted(other.command_time_s, stamps, side="right") - 1
    mode = other.command_mode[held]
    is_driven = (held >= 0) & ((mode == MODE_DRIVE) | (mode == MODE_FLOAT))
    duty = np.where(is_driven, other.command[held], 0.0)
    share = np.where(mode == MODE_FLOAT, np.abs(duty), duty * duty)
    middle = 0.5 * (stamps + np.append(stamps[1:], stamps[-1]))
    _, speed = smoothed(other)
    return np.column_stack([share, duty * np.interp(middle, other.time_s, speed)])
