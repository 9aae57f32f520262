"""Straight lines through a few values each, for many groups at once, with standard deviations not quite trusted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy import stats

from nxt_twin.arrays import FloatArray, IntArray

FIT_DOF: Final = 4.0
"""Degrees of freedom that a fit's own standard deviation is worth, beside the scatter of repeats."""


@final
@dataclass(frozen=True)
class Lines:
    """Of each group its mean and its slope, shape (groups,); NaN where the values do not give them.

    A variance is that of the fits, as repeats correct it: (FIT_DOF + chi²) / (FIT_DOF + dof) times theirs, in the
    manner of a moderated t-test. So neither three lucky repeats nor an optimistic fit alone makes a finding sure.
    """

    count: IntArray
    mean: FloatArray
    mean_std: FloatArray
    slope: FloatArray
    slope_std: FloatArray

    def slope_p(self) -> FloatArray:
        """Two-sided p-value of no slope."""
        return two_sided(self.slope / self.slope_std, np.asarray(FIT_DOF + self.count - 2, dtype=np.float64))


def two_sided(t: FloatArray, dof: FloatArray | float) -> FloatArray:
    """The p-value of Student's t; 1 where there is none."""
    p = 2.0 * stats.t.sf(np.abs(t), dof)
    return np.where(np.isfinite(p), p, 1.0)


def lines(group: IntArray, groups: int, x: FloatArray, y: FloatArray, std: FloatArray) -> Lines:
    """Fit each group's values `y` at `x`, all of shape (values,), by weighted least squares.

    Args:
        group: the group of each value.
        groups: how many there are.
        x: where; only differences within a group count.
        y: values.
        std: their standard deviations, above 0.
    """
    weight = 1.0 / std**2

    def summed(values: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(group, weights=values, minlength=groups), dtype=np.float64)

    count = np.bincount(group, minlength=groups)
    with np.errstate(divide="ignore", invalid="ignore"):
        total = summed(weight)
        mean, middle = summed(weight * y) / total, summed(weight * x) / total
        dy, dx = y - mean[group], x - middle[group]
        xx, xy, yy = (summed(weight * each) for each in (dx * dx, dx * dy, dy * dy))
        slope = np.where((count > 2) & (xx > 0.0), xy / xx, np.nan)
        mean_inflation = (FIT_DOF + yy) / (FIT_DOF + count - 1)
        slope_inflation = (FIT_DOF + np.maximum(yy - xy**2 / xx, 0.0)) / (FIT_DOF + count - 2)
        return Lines(count, mean, np.sqrt(mean_inflation / total), slope, np.sqrt(slope_inflation / xx))
