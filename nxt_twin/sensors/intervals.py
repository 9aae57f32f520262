"""Probabilities of intervals under a normal distribution, safe far out in its tails."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from nxt_twin.arrays import FloatArray

_TINY = 1e-280
_HALF_LOG_2PI = 0.5 * np.log(2.0 * np.pi)


def interval_probability(low: FloatArray, high: FloatArray) -> FloatArray:
    """P(low < Z ≤ high) of a standard normal Z, without loss of digits in either tail."""
    # In the upper half the mirror image: there the two would both be nearly 1.
    side = np.where(low > 0.0, -1.0, 1.0)
    return np.asarray(np.abs(ndtr(side * high) - ndtr(side * low)), dtype=np.float64)


def log_interval_probability(low: FloatArray, high: FloatArray) -> FloatArray:
    """The logarithm of `interval_probability`; far out by the tail's leading term, so that it stays finite."""
    inside = interval_probability(low, high)
    nearest = np.where(low > 0.0, low, np.where(high < 0.0, -high, 0.0))
    far = -0.5 * nearest**2 - np.log(np.maximum(nearest, 1.0)) - _HALF_LOG_2PI
    return np.where(inside > _TINY, np.log(np.maximum(inside, _TINY)), far)


def logistic(x: FloatArray) -> FloatArray:
    """1 / (1 + exp(-x)) without overflow."""
    return np.asarray(0.5 * (1.0 + np.tanh(0.5 * x)), dtype=np.float64)
