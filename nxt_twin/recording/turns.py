"""Goals within one turn, brought into the turn in which the reading is."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray


def at_nearest_turn(goal: FloatArray, reading: FloatArray, turn: float) -> FloatArray:
    """Goals in the turn that is nearest to where the reading has come to when the next goal is given.

    Args:
        goal: in force in each row, shape (rows,).
        reading: unwrapped, in the same unit, shape (rows,); NaN where not sampled.
        turn: after which goals start anew.
    """
    known = np.flatnonzero(np.isfinite(reading))
    there = np.interp(np.arange(goal.size), known, reading[known])
    ends = np.append(np.flatnonzero(np.diff(goal) != 0.0), goal.size - 1)
    end = ends[np.searchsorted(ends, np.arange(goal.size))]
    return np.asarray(goal + turn * np.rint((there[end] - goal) / turn))
