"""Doubts of several parameters whose likelihood has corners and ridges: a crowd that walks over all that is likely.

Stretch moves of Goodman and Weare (2010): half of the crowd moves along lines to the other half, so that steps fit
any ridge by themselves, and the likelihood is worked out for half a crowd at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray

_WALKERS: Final = 48
_STEPS: Final = 600
_FORGOTTEN: Final = 150
_KEPT_EVERY: Final = 3
_STRETCH: Final = 2.0

LogLikelihood = Callable[[FloatArray], FloatArray]
"""Values of shape (walkers, parameters) in; nats of shape (walkers,) out."""


def walked(
    log_likelihood: LogLikelihood,
    start: FloatArray,
    spread: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    rng: Generator,
) -> FloatArray:
    """Values drawn in proportion to their likelihood within bounds, shape (draws, parameters).

    Args:
        log_likelihood: of many at once.
        start: likely values, shape (parameters,).
        spread: how far round them the crowd begins, shape (parameters,).
        bounds: lowest and highest values, shape (parameters,) each.
        rng: where the steps come from.
    """
    low, high = bounds
    begin = start + spread * rng.standard_normal((_WALKERS, start.size))
    crowd = np.clip(begin, low, high)
    nats = log_likelihood(crowd)
    halves = np.arange(_WALKERS // 2), np.arange(_WALKERS // 2, _WALKERS)
    kept = []
    for step in range(_STEPS):
        for moving, standing in (halves, halves[::-1]):
            partners = crowd[rng.choice(standing, moving.size)]
            stretch = ((_STRETCH - 1.0) * rng.random(moving.size) + 1.0) ** 2 / _STRETCH
            there = partners + stretch[:, None] * (crowd[moving] - partners)
            inside = np.all((there >= low) & (there <= high), axis=1)
            found = np.where(inside, log_likelihood(np.clip(there, low, high)), -np.inf)
            gain = (start.size - 1) * np.log(stretch) + found - nats[moving]
            taken = np.log(rng.random(moving.size)) < gain
            crowd[moving[taken]], nats[moving[taken]] = there[taken], found[taken]
        if step >= _FORGOTTEN and step % _KEPT_EVERY == 0:
            kept.append(crowd.copy())
    return np.concatenate(kept)
