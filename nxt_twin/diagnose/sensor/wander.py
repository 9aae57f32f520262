"""Doubts of a likelihood that goes in steps: by a random walk over everything that is likely.

The walk is Metropolis's with steps from the walk's own past (Haario, Saksman, Tamminen 2001), some of them small and
along one parameter alone, so that narrow ridges and wide plateaus are both walked.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.fitting import Free

_STEPS: Final = 5000
_LEARN_EVERY: Final = 250
_ALONE_SHARE: Final = 0.5
_SCALES: Final = (0.1, 0.5, 2.0)
_REACH: Final = 2.4


def wander(
    objective: Callable[[FloatArray], float],
    start: FloatArray,
    covariance: FloatArray,
    free: Sequence[Free],
    rng: Generator,
) -> tuple[FloatArray, FloatArray]:
    """Mean and covariance of the values under the likelihood `objective` (nats) within their bounds.

    Args:
        objective: log-likelihood, with the prior.
        start: the likeliest values, shape (values,).
        covariance: a first idea of their doubt, shape (values, values).
        free: bounds, and changes that matter.
        rng: where the steps come from.
    """
    lower, upper = np.array([part.lower for part in free]), np.array([part.upper for part in free])
    widths = np.array([part.scale for part in free])
    here, height = start.copy(), objective(start)
    root = _root(covariance)
    walked = np.empty((_STEPS, start.size))
    for step in range(_STEPS):
        if step >= 2 * _LEARN_EVERY and step % _LEARN_EVERY == 0:
            root = _root(np.cov(walked[step // 2 : step].T))
        move = np.zeros(start.size)
        if rng.random() < _ALONE_SHARE:
            one = int(rng.integers(start.size))
            move[one] = rng.choice(_SCALES) * widths[one] * rng.standard_normal()
        else:
            move = (
                _REACH / np.sqrt(start.size) * rng.choice(_SCALES) * (root @ rng.standard_normal(start.size))
            )
        there = here + move
        if np.all((there >= lower) & (there <= upper)):
            found = objective(there)
            if np.log(rng.random()) < found - height:
                here, height = there, found
        walked[step] = here
    kept = walked[_STEPS // 4 :]
    return kept.mean(axis=0), np.atleast_2d(np.cov(kept.T))


def _root(covariance: FloatArray) -> FloatArray:
    values, vectors = np.linalg.eigh(np.atleast_2d(covariance))
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)), dtype=np.float64)
