"""Intervals by weighing every value: for thresholds, whose likelihood has edges and flat tops."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.special import logsumexp

from nxt_twin.arrays import FloatArray
from nxt_twin.experiment.identified import Value

_TAIL: Final = 0.025


def weighed(name: str, values: FloatArray, log_weight: FloatArray, unit: str) -> Value:
    """Mean, standard deviation and 95 % interval of values that are so likely, with a flat prior over them.

    Args:
        name: the parameter's.
        values: evenly spaced or each standing for itself, in any order, shape (values,).
        log_weight: logarithm of their likelihood, shape (values,).
        unit: for people.
    """
    weight = np.exp(log_weight - logsumexp(log_weight))
    mean = float(weight @ values)
    std = float(np.sqrt(weight @ (values - mean) ** 2))
    order = np.argsort(values, kind="stable")
    # Half of a value's own weight lies on either side of it.
    mass = np.cumsum(weight[order]) - 0.5 * weight[order]
    low, high = np.interp([_TAIL, 1.0 - _TAIL], mass, values[order])
    return Value(name, mean, std, float(low), float(high), unit)
