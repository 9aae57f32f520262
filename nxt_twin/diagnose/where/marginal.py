"""How likely readings become with some sum of given rows missing, at the likeliest size of its parts."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.linear import Linear

_SIZES = np.geomspace(1e-2, 1e8, 25)
_TOLD = 1e-7  # of the largest eigenvalue of the rows' products: weaker sums of rows are dropped


def likeliest(linear: Linear, parts: Iterable[FloatArray]) -> float:
    """The marginal likelihood of some rows at their likeliest size, over that of nothing missing, nats.

    The rows' shares are independent Gaussians of one variance; what the re-fit takes up of them counts for nothing.
    They come as `parts` of the readings, one after another and each of shape (rows, its readings). So an hour
    of them need not be held at once.
    """
    power, common, likeness = _products(linear, parts)
    shares = linear.shares_of(common)
    gram = power - shares @ common
    own = linear.slopes @ linear.innovations
    along = likeness - shares @ own
    if not np.isfinite(gram).all():  # a run that blew up
        return 0.0
    strengths, axes = np.linalg.eigh(0.5 * (gram + gram.T))
    told = strengths > _TOLD * max(float(strengths[-1]), 1e-300)
    strengths, axes = strengths[told], axes[:, told]
    variances = _SIZES[:, None] / strengths[-1:]
    risen = variances * strengths
    heard = axes.T @ along
    nats = 0.5 * np.sum(variances * heard**2 / (1.0 + risen) - np.log1p(risen), axis=1)
    return max(float(nats.max()), 0.0)


def _products(linear: Linear, parts: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of the rows with one another, of the slopes with the rows, and of the rows with the innovations."""
    power = common = likeness = np.zeros(())
    low = 0
    for part in parts:
        mine = slice(low, low + part.shape[1])
        power = power + part @ part.T
        common = common + linear.slopes[:, mine] @ part.T
        likeness = likeness + part @ linear.innovations[mine]
        low = mine.stop
        del part  # the next one is made only now
    return power, common, likeness
