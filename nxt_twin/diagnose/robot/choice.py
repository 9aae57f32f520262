"""Which effects of the geometry the recordings call for, weighed all against all.

Round the fit of everything, the cost of going without some effects is quadratic in what has to be given up. So every
subset is weighed by one small matrix, and confusion shows as subsets that are nearly as good.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.robot.effects import GEOMETRY, WHEEL_RADIUS, WRONG_TRACK, RobotEffect
from nxt_twin.diagnose.robot.fit import FittedGeometry, robust_nats
from nxt_twin.diagnose.robot.windows import PARAMETERS

NEEDED_NATS: Final = 6.0
"""The gain that an effect needs; each parameter beyond the first asks for one more."""

RIVAL_NATS: Final = 5.0
"""A subset that is behind the best by less cannot be told from it."""

_MATTERS: Final = np.array([1.5e-3, 5e-4, 2e-3, 5e-4, 5e-4, 0.1])
"""Smaller deviations are re-fitted and not named: radius and track relative, ratio, offsets in m, heading in deg."""


@final
@dataclass(frozen=True)
class GeometryChoice:
    """The chosen effects.

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


def choose(full: FittedGeometry, given: FloatArray, blur: FloatArray | None = None) -> GeometryChoice:
    """Weigh every subset of the effects of the geometry.

    Args:
        full: a fit in which all parameters were free.
        given: the values as the model came, shape (6,).
        blur: by how much slip that nobody located may move the fit, shape (6,); None where there is none.
    """
    off = full.state.geometry - given
    if blur is not None:
        off = beyond(off, blur)
    able = {
        effect.id: [place for place in places_of(effect) if full.free[place]]
        for effect in GEOMETRY
        if _matters(off, given, effect)
    }
    weighed = weigh(able, off, full.covariance, full.clusters)
    named = tuple(effect for effect in GEOMETRY if effect.id in weighed.best)
    probability = {effect.id: weighed.probability.get(effect.id, 0.0) for effect in GEOMETRY}
    return GeometryChoice(named, probability, _with_untold(weighed.rivals, full), weighed.second)


def _with_untold(rivals: dict[str, tuple[str, ...]], full: FittedGeometry) -> dict[str, tuple[str, ...]]:
    """Rivals, with the wheels' radius beside a track where the paths tell only the ratio of both."""
    if WRONG_TRACK.id not in rivals or full.free[places_of(WHEEL_RADIUS)].all():
        return rivals
    others = dict.fromkeys((WHEEL_RADIUS.id, *rivals[WRONG_TRACK.id]))
    return {**rivals, WRONG_TRACK.id: tuple(others)}


@final
@dataclass(frozen=True)
class WeighedSubsets:
    """Which effects are called for.

    Attributes:
        best: ids of the best subset.
        probability: of every effect.
        rivals: of each named effect, the ids that could stand in its place.
        second: subsets in which something else is named, best first, with how many nats they are behind.
    """

    best: frozenset[str]
    probability: dict[str, float]
    rivals: dict[str, tuple[str, ...]]
    second: tuple[tuple[frozenset[str], float], ...]


def weigh(
    able: Mapping[str, list[int]], off: FloatArray, covariance: FloatArray, clusters: int
) -> WeighedSubsets:
    """Weigh every subset of effects by what is lost without the others.

    Args:
        able: the effects, each with the places of its parameters.
        off: how far the parameters are from where they would be without effects.
        covariance: of `off`.
        clusters: how many independent parts it rests on.
    """
    scores: dict[frozenset[str], float] = {}
    for size in range(len(able) + 1):
        for kept in itertools.combinations(able, size):
            dropped = [place for one, places in able.items() if one not in kept for place in places]
            asked = sum(asked_of(len(able[one])) for one in kept)
            lost = sum(robust_nats(one, clusters) for one in _independent(off, covariance, dropped))
            scores[frozenset(kept)] = -lost - asked
    best = max(scores, key=lambda ids: (scores[ids], -len(ids)))
    weight = {ids: float(np.exp(score - scores[best])) for ids, score in scores.items()}
    total = sum(weight.values())
    probability = {one: sum(value for ids, value in weight.items() if one in ids) / total for one in able}
    order = sorted(scores, key=lambda ids: -scores[ids])
    second = tuple((ids, scores[best] - scores[ids]) for ids in order if ids - best)
    return WeighedSubsets(best, probability, {one: _rivals(one, best, second) for one in best}, second)


def asked_of(parameters: int) -> float:
    """The gain that an effect needs by the number of its parameters, nats."""
    return NEEDED_NATS + parameters - 1.0


def beyond(off: FloatArray, least: FloatArray) -> FloatArray:
    """How far deviations go beyond the sizes that matter; zero for smaller ones.

    Evidence has to speak for a size that matters. A place that is exact and tiny would else lend its evidence to
    another that is large and uncertain.
    """
    return np.asarray(np.sign(off) * np.maximum(np.abs(off) - least, 0.0))


def _matters(off: FloatArray, given: FloatArray, effect: RobotEffect) -> bool:
    least = _MATTERS.copy()
    least[[0, 2]] *= given[[0, 2]]
    places = places_of(effect)
    return bool(np.any(np.abs(off[places]) > least[places]))


def _independent(off: FloatArray, covariance: FloatArray, places: list[int]) -> list[float]:
    """Squared deviations in standard deviations, each given those before it, the farthest off first."""
    if not places:
        return []
    inner = covariance[np.ix_(places, places)]
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
