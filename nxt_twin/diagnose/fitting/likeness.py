"""Motors that move all alike: twice every torque, inertia and current at half of every resistance.

Angle and voltage cannot tell one of them from another; only the given numbers and their priors can.
"""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray

_ROUNDS = 6  # of a fixed point that is near after three


def told_apart(slopes: FloatArray, along: FloatArray) -> FloatArray:
    """`slopes` without what they have between such motors, shape (variables, readings).

    There the slopes hold only errors of finite differences, from stops, sticking and late readings. A fit
    would take these errors for evidence, where only the priors know anything.

    Args:
        slopes: of each reading for each variable, in the variable's scale.
        along: how the variables, in their scales, change from one such motor to the next, shape (variables,).
    """
    size = float(along @ along)
    return np.asarray(slopes - np.outer(along, along @ slopes) / size) if size > 0.0 else slopes


def most_likely(
    x: FloatArray, likeness: FloatArray, centre: FloatArray, spread: FloatArray, logs: BoolArray
) -> FloatArray:
    """Of all motors that move as that of `x` the one that the weak priors hold for the likeliest.

    Args:
        x: values of the variables, as all else shape (variables,).
        likeness: the power with which each grows from one such motor to the next.
        centre: means of the priors.
        spread: their standard deviations, inf where there is none.
        logs: which values, centres and deviations are of logarithms.
    """
    if not likeness.any():
        return x
    size = 0.0
    for _ in range(_ROUNDS):
        grown = np.where(logs, x + likeness * size, x * np.exp(likeness * size))
        slope = likeness * np.where(logs, 1.0, grown) / spread
        steepness = max(float(slope @ slope), 1e-300)
        size -= float(np.clip(float(slope @ ((grown - centre) / spread)) / steepness, -0.5, 0.5))
    return np.asarray(np.where(logs, x + likeness * size, x * np.exp(likeness * size)))
