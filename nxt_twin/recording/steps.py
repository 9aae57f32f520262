"""The smallest step of a reading, as its values show it."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray

_FINEST = 20_000  # steps that a reading spans; finer ones are the digits it was printed with
_DISTINCT = 8


def smallest_step(values: FloatArray) -> float:
    """The step of which all differences between values are multiples, in their unit; 0 where none shows."""
    levels = np.unique(values[np.isfinite(values)])
    if levels.size < _DISTINCT:
        return 0.0
    gaps = np.diff(levels)
    least = float(np.quantile(gaps, 0.05))
    if least <= 0.0 or float(np.ptp(levels)) / least > _FINEST:
        return 0.0
    multiples = gaps / least
    if np.mean(np.abs(multiples - np.rint(multiples)) > 0.1 * np.maximum(1.0, 0.02 * multiples)) > 0.02:
        return 0.0
    return float(np.sum(gaps) / np.sum(np.rint(multiples)))
