"""How much single readings tell of one another once a plant has predicted them."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray

COLOURED = 1.4
"""Colour, over that of noise, from which a likelihood of single steps counts readings that are no evidence.

Of synthetic recordings whose missing effects were found it is 1.0 to 1.3. Of a real servo that was logged on another
clock than it was read by it is 1.5 to 3.3: which, the rounding of the linear algebra decides. Of 24 unknown effects
each of the seeds 721 and 722, a limit of 1.4 in place of 1.6 names none; a small one becomes adequate.
"""

_LAGS = 20  # readings: the longest lag of an autocorrelation that counts


def colour(innovations: FloatArray, run: IntArray) -> FloatArray:
    """How many readings count as one in a comparison of likelihoods, shape (cases,): 1 where all are independent.

    It is 1 plus twice the sum of squared autocorrelations. That factor widens the scatter of an effect's
    score, where its signature is coloured alike.

    Args:
        innovations: shape (cases, readings), recordings one after another.
        run: the recording that each reading is of, shape (readings,).
    """
    found = [_of_one(innovations[:, run == one]) for one in np.unique(run)]
    return np.asarray(np.median(found, axis=0))


def _of_one(innovations: FloatArray) -> FloatArray:
    size = innovations.shape[1]
    power = np.maximum(np.sum(innovations**2, axis=1), 1e-12)
    total = np.ones(len(innovations))
    for lag in range(1, min(_LAGS, size - 1) + 1):
        alike = np.sum(innovations[:, lag:] * innovations[:, : size - lag], axis=1)
        total += 2.0 * (alike / power) ** 2
    return total
