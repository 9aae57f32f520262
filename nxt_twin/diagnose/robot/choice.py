"""Which effects of the geometry the recordings call for, weighed all against all.

Round the fit of everything, the cost of going without some effects is quadratic in what has to be given up. So every
subset is weighed by one small matrix, and confusion shows as subsets that are nearly as good.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.robot.effects import GEOMETRY, RobotEffect
from nxt_twin.diagnose.robot.fit import FittedGeometry, robust_nats
from nxt_twin.diagnose.robot.windows import PARAMETERS

NEEDED_NATS: Final = 6.0
"""What an effect has to gain; each parameter beyond the first asks for one more."""

RIVAL_NATS: Final = 5.0
"""A subset that is behind the best by less cannot be told from it."""

_MATTERS: Final = np.array([1e-3, 5e-4, 2e-3, 5e-4, 5e-4, 0.1])
"""Smaller deviations are re-fitted and not named: radius and track relative, ratio, offsets in m, heading in deg."""


@final
@dataclass(frozen=True)
class GeometryChoice:
    """What was chosen.

    Attributes:
        named: the effects, in the library's order.
        probability: of every effect of the geometry, by id.
        rivals: of each named effect, the ids that could stand in its place.
        second: subsets in which something else is named, best first, with how many nats they are behind.
    """

    named: tuple[RobotEffect, ...]
    probability: dict[str, float]
    rivals: dict[str, tuple[str, ...]]
    second: tuple[tuple[frozenset[str], float], ...]


def places_of(effect: RobotEffect) -> list[int]:
    """Where an effect's parameters stand in a fit's vector."""
    return [PARAMETERS.index(name) for name in effect.units]


def choose(full: FittedGeometry, given: FloatArray) -> GeometryChoice:
    """Weigh every subset of the effects of the geometry.

    Args:
        full: a fit in which all parameters were free.
        given: the values as the model came, shape (6,).
    """
    off = full.state.geometry - given
    able = [effect for effect in GEOMETRY if _matters(off, given, effect)]
    scores: dict[frozenset[str], float] = {}
    for size in range(len(able) + 1):
        for kept in itertools.combinations(able, size):
            scores[frozenset(effect.id for effect in kept)] = _score(full, off, able, kept)
    best = max(scores, key=lambda ids: (scores[ids], -len(ids)))
    weight = {ids: float(np.exp(score - scores[best])) for ids, score in scores.items()}
    total = sum(weight.values())
    probability = {
        effect.id: sum(value for ids, value in weight.items() if effect.id in ids) / total
        for effect in GEOMETRY
    }
    order = sorted(scores, key=lambda ids: -scores[ids])
    second = tuple((ids, scores[best] - scores[ids]) for ids in order if ids - best)
    named = tuple(effect for effect in GEOMETRY if effect.id in best)
    rivals = {effect.id: _rivals(effect.id, best, second) for effect in named}
    return GeometryChoice(named, probability, rivals, second)


def _matters(off: FloatArray, given: FloatArray, effect: RobotEffect) -> bool:
    least = _MATTERS.copy()
    least[[0, 2]] *= given[[0, 2]]
    places = places_of(effect)
    return bool(np.any(np.abs(off[places]) > least[places]))


def _score(
    full: FittedGeometry, off: FloatArray, able: list[RobotEffect], kept: tuple[RobotEffect, ...]
) -> float:
    """Minus the nats lost without the others, minus what those that are kept have to gain."""
    dropped = [place for effect in able if effect not in kept for place in places_of(effect)]
    asked = sum(NEEDED_NATS + len(effect.units) - 1 for effect in kept)
    if not dropped:
        return -asked
    return -sum(robust_nats(lost, full.clusters) for lost in _independent(full, off, dropped)) - asked


def _independent(full: FittedGeometry, off: FloatArray, places: list[int]) -> list[float]:
    """Squared deviations in standard deviations, each given those before it, the farthest off first."""
    inner = full.covariance[np.ix_(places, places)]
    std = np.sqrt(np.diag(inner))
    far = off[places] / std
    order = np.argsort(-np.abs(far))
    likeness = (inner / np.outer(std, std))[np.ix_(order, order)] + 1e-9 * np.eye(len(places))
    return [float(one) for one in np.linalg.solve(np.linalg.cholesky(likeness), far[order]) ** 2]


def _rivals(
    named: str, best: frozenset[str], second: tuple[tuple[frozenset[str], float], ...]
) -> tuple[str, ...]:
    found: list[str] = []
    for ids, behind in second:
        if behind < RIVAL_NATS and named not in ids and ids - best:
            found += sorted(ids - best)
    return tuple(dict.fromkeys(found))
