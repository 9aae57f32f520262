"""Doubts of several parameters whose likelihood has corners and ridges: a crowd that walks over all that is likely.

Stretch moves of Goodman and Weare (2010): half of the crowd moves along lines to the other half. The steps so fit any
ridge by themselves, and the likelihood is computed for half a crowd at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray

_FORGOTTEN: Final = 0.25
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
    *,
    walkers: int = 48,
    steps: int = 600,
) -> FloatArray:
    """Values drawn in proportion to their likelihood within bounds, shape (draws, parameters).

    Args:
        log_likelihood: of many at once.
        start: likely values, shape (parameters,).
        spread: how far round them the crowd begins, shape (parameters,).
        bounds: lowest and highest values, shape (parameters,) each.
        rng: where the steps come from.
        walkers: how many walk, an even number; twice as many as there are parameters at least.
        steps: of each walker; the first quarter is forgotten.
    """
    low, high = bounds
    begin = start + spread * rng.standard_normal((walkers, start.size))
    crowd = np.clip(begin, low, high)
    nats = log_likelihood(crowd)
    halves = np.arange(walkers // 2), np.arange(walkers // 2, walkers)
    kept = []
    for step in range(steps):
        for moving, standing in (halves, halves[::-1]):
            partners = crowd[rng.choice(standing, moving.size)]
            stretch = ((_STRETCH - 1.0) * rng.random(moving.size) + 1.0) ** 2 / _STRETCH
            there = partners + stretch[:, None] * (crowd[moving] - partners)
            inside = np.all((there >= low) & (there <= high), axis=1)
            found = np.where(inside, log_likelihood(np.clip(there, low, high)), -np.inf)
            gain = (start.size - 1) * np.log(stretch) + found - nats[moving]
            taken = np.log(rng.random(moving.size)) < gain
            crowd[moving[taken]], nats[moving[taken]] = there[taken], found[taken]
        if step >= _FORGOTTEN * steps and step % _KEPT_EVERY == 0:
            kept.append(crowd.copy())
    return np.concatenate(kept)
