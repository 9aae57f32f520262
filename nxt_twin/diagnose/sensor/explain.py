"""Which effects a sensor needs: forward selection, exchange, backward elimination."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import log
from typing import final

import numpy as np

from nxt_twin.diagnose.sensor.declaration import SensorEffect
from nxt_twin.diagnose.sensor.structure import SensorFitter, SensorStructure

NEEDED_NATS = 6.0
"""The gain beyond its parameters' penalty (half a BIC) that an effect needs to come in, and to stay."""

RIVAL_NATS = 6.0
"""Another effect in its place that is behind by less cannot be told from it."""

_CHECK_NATS = 1.0  # gain on the items that check, or, where the whole gain is obvious, loss
_OBVIOUS_NATS = 20.0
"""An effect must do better on the items that check it by the first; where they hardly show it, for it lives in a
narrow range, it must not do worse by as much, and gain the second."""

_MOST_EFFECTS = 4  # that a search may add
_PROMISING_NATS = 2.0  # gain on the fitted items from which a candidate is fitted to the end
_FAR_BEHIND_NATS = 60.0
"""What gradient steps alone must reach for a candidate, or a rival, to be fitted to the end."""


@final
@dataclass(frozen=True)
class SensorRival:
    """An effect in another's place, and by how many nats it is behind."""

    effect: SensorEffect
    structure: SensorStructure
    behind: float


@final
@dataclass(frozen=True)
class SensorExplanation:
    """The findings of the search.

    Attributes:
        best: the structure, fitted on all that is not held out.
        gained: for each of its effects, the nats that it earns beyond its share.
        rivals: for each, what might stand in its place, nearest first.
        refused: the effect that came nearest where none was found, with its gain.
    """

    best: SensorStructure
    gained: dict[str, float]
    rivals: dict[str, tuple[SensorRival, ...]]
    refused: tuple[SensorEffect, float] | None


def explain(
    fitter: SensorFitter, baseline: SensorStructure, progress: Callable[[str], None]
) -> SensorExplanation:
    """Add effects while they pay, then drop those that no longer do, then look for rivals."""
    best, refused = baseline, None
    while len(best.active) < _MOST_EFFECTS:
        tried = list(_tried(fitter, best, progress))
        passing = [(gain, other) for gain, other in tried if _pays(best, other, gain)]
        if not passing:
            if not best.active and tried:
                gain, other = max(tried, key=lambda each: each[0])
                refused = (other.active[-1], gain)
            break
        best = max(passing, key=lambda each: each[0])[1]
    best, gained = _pruned(fitter, best)
    rivals = {effect.id: _rivals(fitter, best, effect) for effect in best.active}
    return SensorExplanation(fitter.on_everything(best), gained, rivals, refused)


def _tried(
    fitter: SensorFitter, best: SensorStructure, progress: Callable[[str], None]
) -> list[tuple[float, SensorStructure]]:
    found = []
    for effect in fitter.problem.effects:
        if effect.id in best.ids:
            continue
        progress(f"trying {effect.name}")
        other = fitter.with_effect(best, effect, best.fit_nats + _PROMISING_NATS)
        if other is not None:
            found.append((_gain(fitter, best, other), other))
    return found


def _gain(fitter: SensorFitter, fewer: SensorStructure, more: SensorStructure) -> float:
    """What `more` gains beyond the share of its parameters and of where they were looked for, nats."""
    nats = more.fit_nats - fewer.fit_nats + more.check_nats - fewer.check_nats
    count = int(np.count_nonzero(fitter.split.known))
    share = 0.5 * (len(more.names) - len(fewer.names)) * log(max(count, 2))
    looked = sum(effect.prior_nats for effect in more.active) - sum(e.prior_nats for e in fewer.active)
    return nats * more.independent - share - looked


def _pays(fewer: SensorStructure, more: SensorStructure, gain: float) -> bool:
    checked = more.check_nats - fewer.check_nats
    bears_it_out = checked > _CHECK_NATS or (checked > -_CHECK_NATS and gain > _OBVIOUS_NATS)
    return gain > NEEDED_NATS and bears_it_out


def _pruned(fitter: SensorFitter, best: SensorStructure) -> tuple[SensorStructure, dict[str, float]]:
    """The structure without effects that do not pay once the others are in, and what each of the rest gains."""
    while best.active:
        rest = [(effect, fitter.without(best, effect)) for effect in best.active]
        gains = {effect.id: _gain(fitter, fewer, best) for effect, fewer in rest}
        worst, fewer = min(rest, key=lambda each: gains[each[0].id])
        if gains[worst.id] > NEEDED_NATS:
            return best, gains
        best = fewer
    return best, {}


def _rivals(fitter: SensorFitter, best: SensorStructure, effect: SensorEffect) -> tuple[SensorRival, ...]:
    fewer = fitter.without(best, effect)
    own = _gain(fitter, fewer, best)
    found = []
    for other in fitter.problem.effects:
        if other.id in best.ids:
            continue
        changed = fitter.with_effect(fewer, other, best.fit_nats - _FAR_BEHIND_NATS)
        if changed is not None:
            found.append(SensorRival(other, changed, own - _gain(fitter, fewer, changed)))
    return tuple(sorted(found, key=lambda rival: rival.behind))
