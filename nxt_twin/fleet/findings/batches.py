"""Effects that the units of a batch have in common, and other units lack."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from scipy import stats

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.fleet.findings.by_unit import by_unit
from nxt_twin.fleet.findings.columns import Sessions
from nxt_twin.fleet.findings.control import q_values
from nxt_twin.fleet.findings.values import Common

_FEWEST: Final = 3
"""Units in a batch, and outside of it, below which nothing is said."""


def commons(sessions: Sessions, level: float) -> list[Common]:
    """Effects that are commoner in a batch (Fisher's exact test) and parameters that differ (Mann and Whitney's)."""
    batch = np.full(len(sessions.units), -1)
    batch[sessions.unit] = sessions.batch
    has = _has_effect(sessions)
    units = by_unit(sessions)
    found: list[tuple[Common, float]] = []
    for number, name in enumerate(sessions.batches):
        inside, outside = batch == number, (batch != number) & (batch >= 0)
        if min(inside.sum(), outside.sum()) < _FEWEST:
            continue
        found += [
            _effect(name, effect, has[:, kind], inside, outside)
            for kind, effect in enumerate(sessions.effects.names)
        ]
        for kind, parameter in enumerate(sessions.parameters.names):
            of = units.name == kind
            mean, unit = units.fitted.mean[of], units.unit[of]
            if min(inside[unit].sum(), outside[unit].sum()) >= _FEWEST:
                found.append(_parameter(name, parameter, mean[inside[unit]], mean[outside[unit]]))
    q = q_values(np.array([p for _, p in found]))
    sure = [
        replace(common, q=rate) for (common, _), rate in zip(found, q.tolist(), strict=True) if rate <= level
    ]
    return sorted(sure, key=lambda common: (common.q, common.batch))


def _has_effect(sessions: Sessions) -> BoolArray:
    """Whether an effect was found in any session of a unit, shape (units, effects)."""
    has = np.zeros((len(sessions.units), len(sessions.effects.names)), dtype=bool)
    has[sessions.unit[sessions.effects.row], sessions.effects.name] = True
    return has


def _effect(
    batch: str, effect: str, has: BoolArray, inside: BoolArray, outside: BoolArray
) -> tuple[Common, float]:
    table = [[int((has & side).sum()), int((~has & side).sum())] for side in (inside, outside)]
    p = float(stats.fisher_exact(table, alternative="greater").pvalue)
    shares = [float(has[side].mean()) for side in (inside, outside)]
    return Common(batch, effect, "effect", shares[0], shares[1], int(inside.sum()), 1.0), p


def _parameter(batch: str, name: str, inside: FloatArray, outside: FloatArray) -> tuple[Common, float]:
    p = float(stats.mannwhitneyu(inside, outside).pvalue)
    medians = float(np.median(inside)), float(np.median(outside))
    return Common(batch, name, "parameter", *medians, inside.size, 1.0), p
