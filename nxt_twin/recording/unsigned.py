"""Commands that lost their sign: a logger that writes only their size."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray

LEAST_BACK = 0.2
"""Share of the travel, either way, from which a command of one sign drove a motor both ways.

What a motor overshoots after a reversal stays below it. Set on the log of a stranger's position loop (0.49)."""


def lost_sign(command: FloatArray, reading: FloatArray) -> bool:
    """Whether a motor runs both ways while commands of one sign alone drive it.

    A weight can pull a motor back against its command, so this is a doubt and no proof.

    Args:
        command: in force from each row until the next, shape (rows,); NaN where unknown.
        reading: angle or position, shape (rows,); NaN where a row has none.
    """
    known = np.isfinite(reading) & np.isfinite(command)
    driven = command[known][:-1]
    if not driven.any() or (driven.min() < 0.0 < driven.max()):
        return False
    travel = np.diff(reading[known])[driven != 0.0]
    ahead, back = float(travel[travel > 0.0].sum()), -float(travel[travel < 0.0].sum())
    return min(ahead, back) > LEAST_BACK * (ahead + back)
