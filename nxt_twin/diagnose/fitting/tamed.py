"""Numbers of a simulation that ran away."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray

_RAN_AWAY = 1e30  # above which a number stands for a run that ran away


def tamed(values: FloatArray) -> FloatArray:
    """The values, small enough that sums of their products are numbers; no number counts as 0."""
    if values.size == 0 or (values.min() >= -_RAN_AWAY and values.max() <= _RAN_AWAY):
        return values  # nearly always, and no copy; where there is a NaN, both comparisons fail
    return np.asarray(np.clip(np.nan_to_num(values), -_RAN_AWAY, _RAN_AWAY))
