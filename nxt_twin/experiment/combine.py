"""Put together what several fits say, with what each of them does not know."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import least_squares

from nxt_twin.arrays import FloatArray

_DIFFERENCE: Final = 1e-6


def combined(
    measured: FloatArray,
    covariance: FloatArray,
    model: Callable[[FloatArray], FloatArray],
    start: FloatArray,
) -> tuple[FloatArray, FloatArray, float]:
    """Generalised least squares: the x for which `model(x)` is nearest to what was measured.

    Args:
        measured: shape (measured,).
        covariance: of it, shape (measured, measured).
        model: gives what should be measured.
        start: where to begin, shape (unknowns,).

    Returns:
        x, its covariance, and what is left: the sum of squares in units of the covariance.
    """
    whitener = np.linalg.inv(np.linalg.cholesky(covariance))
    scale = np.maximum(np.abs(start), 1e-12)

    def left(z: FloatArray) -> FloatArray:
        return np.asarray(whitener @ (model(z * scale) - measured))

    best = least_squares(left, start / scale, method="trf", x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14)
    factor = cho_factor(best.jac.T @ best.jac)
    spread = cho_solve(factor, np.eye(start.size)) * np.outer(scale, scale)
    return best.x * scale, spread, float(2.0 * best.cost)


def propagated(
    function: Callable[[FloatArray], FloatArray], x: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """A function's value and covariance, to first order."""
    value = function(x)
    columns = []
    for index in range(x.size):
        step = _DIFFERENCE * max(abs(x[index]), 1e-9)
        ahead, behind = x.copy(), x.copy()
        ahead[index] += step
        behind[index] -= step
        columns.append((function(ahead) - function(behind)) / (2.0 * step))
    slopes = np.array(columns).T
    return value, slopes @ covariance @ slopes.T
