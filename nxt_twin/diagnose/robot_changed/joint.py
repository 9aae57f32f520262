"""Two fits under the claim that they share most of their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray


@final
@dataclass(frozen=True)
class FittedSide:
    """A fit of one side.

    Attributes:
        values: shape (numbers,).
        covariance: theirs.
        clusters: how many independent parts it rests on.
    """

    values: FloatArray
    covariance: FloatArray
    clusters: int


@final
@dataclass(frozen=True)
class JointSides:
    """Both sides, where only some numbers differ.

    Attributes:
        before: values, shape (numbers,).
        before_covariance: theirs.
        off: after less before; zero where shared.
        off_covariance: of `off`.
    """

    before: FloatArray
    before_covariance: FloatArray
    off: FloatArray
    off_covariance: FloatArray

    @property
    def after(self) -> FloatArray:
        """Values after, shape (numbers,)."""
        return self.before + self.off


def joint(before: FittedSide, after: FittedSide, told: Sequence[int], differs: Sequence[int]) -> JointSides:
    """The most likely numbers of both sides if all but those at `differs` are alike.

    Round both fits the likelihood is quadratic, so that this takes no further fit.

    Args:
        before: that side by itself.
        after: likewise.
        told: places that both sides tell; the others stay as they are before.
        differs: places, out of those, that may differ.
    """
    off, covariance = after.values - before.values, before.covariance + after.covariance
    alike = [place for place in told if place not in differs]
    values, own = before.values.copy(), before.covariance.copy()
    if alike:
        inner = np.linalg.inv(covariance[np.ix_(alike, alike)])
        gain = covariance[:, alike] @ inner
        pull = before.covariance[:, alike] @ inner
        values = values + pull @ off[alike]
        own = own - pull @ before.covariance[alike]
        off = off - gain @ off[alike]
        covariance = covariance - gain @ covariance[alike]
    kept = np.zeros(off.size, dtype=bool)
    kept[list(differs)] = True
    return JointSides(values, own, np.where(kept, off, 0.0), np.where(np.outer(kept, kept), covariance, 0.0))
