"""False discoveries, controlled over a fleet."""

from __future__ import annotations

import numpy as np
from scipy import stats

from nxt_twin.arrays import FloatArray


def q_values(p: FloatArray, tests: int | None = None) -> FloatArray:
    """The false discovery rate at which each finding is the last that is accepted (Benjamini and Hochberg).

    Args:
        p: p-values, shape (findings,), each in 0…1.
        tests: how many were made; those that found nothing have a p-value of 1 and are not in `p`.
    """
    if not p.size:
        return p
    share = max(tests or p.size, p.size) / p.size
    return np.minimum(np.asarray(stats.false_discovery_control(p, method="bh")) * share, 1.0)
