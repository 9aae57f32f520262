"""Find the effects that the data call for: forward one at a time, then backward, then what could stand in."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.structure import Structure, Weight, Workshop, free_run_ratio, weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals

Progress = Callable[[str], None]

MOST_EFFECTS = 4
GAIN_NATS = 6.0
CHECK_NATS = 2.0
KEEP_NATS = 3.0
RIVAL_NATS = 6.0
FREE_RUN_RATIO = 1.01  # a structure that predicts one step better and runs freely worse has learnt noise

_SHORT_LIST = 5
_QUICK_ITERATIONS = 5
_SLOW_ITERATIONS = 12
_EXCHANGES = 2


@final
@dataclass(frozen=True)
class Rival:
    """An effect that does nearly as well in the place of a found one; `behind` in nats, negative if better."""

    effect: Effect
    behind: float
    structure: Structure


@final
@dataclass(frozen=True)
class Explanation:
    """What the search found.

    Attributes:
        baseline: the re-fitted baseline.
        best: the structure with every effect that earned its place.
        found: those effects, the weightiest first, each with what speaks for keeping it.
        rivals: for each found effect, others tried in its place, best first.
        refused: effects that came nearest to being added at the end, best first, with their weight.
    """

    baseline: Structure
    best: Structure
    found: tuple[tuple[Effect, Weight], ...]
    rivals: dict[str, tuple[Rival, ...]]
    refused: tuple[tuple[Effect, Weight], ...]


def explain(workshop: Workshop, baseline: Structure, progress: Progress) -> Explanation:
    """Search the library for what the re-fitted `baseline` lacks."""
    best = baseline
    tried: list[Effect] = []
    for exchange in range(_EXCHANGES + 1):
        best, refused = _grown(workshop, best, baseline, tried, progress)
        progress("checking each effect's place")
        found = _found(workshop, best, baseline)
        rivals = {effect.id: _rivals(workshop, best, effect, tried) for effect, _ in found}
        better = _better(best, rivals)
        if better is None or exchange == _EXCHANGES:
            break
        best = _pruned(workshop, better, baseline)
    return Explanation(baseline, best, found, rivals, refused)


def _grown(
    workshop: Workshop, best: Structure, baseline: Structure, tried: list[Effect], progress: Progress
) -> tuple[Structure, tuple[tuple[Effect, Weight], ...]]:
    """Add effects to `best` while one earns its place; what came near is noted in `tried`."""
    while True:
        progress(f"trying each effect with {_names(best.plant, baseline.plant)}")
        ranked = _forward(workshop, best)
        tried.extend(effect for effect, _, _ in ranked if effect not in tried)
        full = len(best.plant.active - baseline.plant.active) >= MOST_EFFECTS
        if not ranked or full or not _worth_it(ranked[0][1]):
            return best, tuple((effect, weight) for effect, weight, _ in ranked)
        added = _pruned(workshop, ranked[0][2], baseline)
        if added.plant.active == best.plant.active:
            return added, tuple((effect, weight) for effect, weight, _ in ranked)
        best = added


def _better(best: Structure, rivals: dict[str, tuple[Rival, ...]]) -> Structure | None:
    """The structure with one effect exchanged that clearly beats `best`, in free run as well."""
    beating = [
        rival
        for near in rivals.values()
        for rival in near
        if rival.behind < -RIVAL_NATS and free_run_ratio(best, rival.structure) < FREE_RUN_RATIO
    ]
    return min(beating, key=lambda rival: rival.behind).structure if beating else None


def candidates(plant: Plant, signals: Signals) -> list[Effect]:
    """The effects that `plant` lacks and could have, driven as it is."""
    superseded = {gone for effect in plant.effects for gone in effect.supersedes}
    return [
        effect
        for effect in plant.layout.effects
        if effect.id not in plant.active
        and effect.id not in superseded
        and (not effect.inputs or signals.input_kind in effect.inputs)
    ]


def _worth_it(weight: Weight) -> bool:
    return (
        weight.gain > GAIN_NATS and weight.check_gain > CHECK_NATS and weight.free_run_ratio < FREE_RUN_RATIO
    )


def _keeps_its_place(weight: Weight) -> bool:
    return weight.total > KEEP_NATS and weight.check_gain > 0.0 and weight.free_run_ratio < FREE_RUN_RATIO


def _forward(workshop: Workshop, best: Structure) -> list[tuple[Effect, Weight, Structure]]:
    """Every candidate added to `best`, the likeliest of them under noise of their own, ranked.

    Effects with states of their own (a second mass) reach their best slowly, so they are always followed up.
    """
    quick = []
    for effect in candidates(best.plant, workshop.problem.signals[0]):
        start = workshop.start_with(best.plant, effect, best.noise)
        iterations = _SLOW_ITERATIONS if effect.states else _QUICK_ITERATIONS
        trial = workshop.fit(start, best.noise, iterations=iterations)
        quick.append((effect, weigh(best, trial), trial))
    quick.sort(key=lambda item: -item[1].total)
    followed = [
        (effect, trial)
        for rank, (effect, _, trial) in enumerate(quick)
        if rank < _SHORT_LIST or effect.states
    ]
    settled = [(effect, workshop.settle(trial)) for effect, trial in followed]
    ranked = [(effect, weigh(best, trial), trial) for effect, trial in settled]
    ranked.sort(key=lambda item: (-_worth_it(item[1]), -item[1].total))
    return ranked


def _pruned(workshop: Workshop, best: Structure, baseline: Structure) -> Structure:
    """Take out, one at a time, effects that no longer earn their place."""
    while True:
        weakest: tuple[float, Structure] | None = None
        for effect_id in sorted(best.plant.active - baseline.plant.active):
            simpler, weight = _without(workshop, best, effect_id)
            if not _keeps_its_place(weight) and (weakest is None or weight.total < weakest[0]):
                weakest = (weight.total, simpler)
        if weakest is None:
            return best
        best = weakest[1]


def _without(workshop: Workshop, best: Structure, effect_id: str) -> tuple[Structure, Weight]:
    plant = _simpler(best.plant, effect_id, workshop.problem.plant)
    simpler = workshop.settle(workshop.fit(plant, best.noise, iterations=_QUICK_ITERATIONS))
    return simpler, weigh(simpler, best)


def _simpler(plant: Plant, effect_id: str, baseline: Plant) -> Plant:
    """`plant` without the effect; the plain terms that it had replaced come back."""
    effect = plant.layout.effect(effect_id)
    bare = plant.without([effect_id])
    mean = sum(plant.values[Slot(effect_id, p.symbol)] for p in effect.parameters) / len(effect.parameters)
    for plain in effect.supersedes:
        symbol = plant.layout.effect(plain).parameters[0].symbol
        bare = bare.with_effect(plain, {symbol: baseline.values.get(Slot(plain, symbol), mean)})
    return bare


def _found(workshop: Workshop, best: Structure, baseline: Structure) -> tuple[tuple[Effect, Weight], ...]:
    weighed = [
        (best.plant.layout.effect(effect_id), _without(workshop, best, effect_id)[1])
        for effect_id in sorted(best.plant.active - baseline.plant.active)
    ]
    return tuple(sorted(weighed, key=lambda item: -item[1].total))


def _rivals(workshop: Workshop, best: Structure, effect: Effect, ranked: list[Effect]) -> tuple[Rival, ...]:
    """Effects that were near at some time, or are declared confusable, put in the place of `effect`."""
    bare, _ = _without(workshop, best, effect.id)
    wanted = [*effect.confusable_with, *(other.id for other in ranked)]
    allowed = {other.id: other for other in candidates(bare.plant, workshop.problem.signals[0])}
    rivals: list[Rival] = []
    for other_id in dict.fromkeys(wanted):
        if other_id == effect.id or other_id not in allowed or len(rivals) >= _SHORT_LIST:
            continue
        start = workshop.start_with(bare.plant, allowed[other_id], best.noise)
        trial = workshop.settle(workshop.fit(start, best.noise, iterations=_QUICK_ITERATIONS))
        rivals.append(Rival(allowed[other_id], weigh(trial, best).total, trial))
    return tuple(sorted(rivals, key=lambda rival: rival.behind))


def probability(behind: float, others: list[float]) -> float:
    """The share of belief for a structure `behind` the best by so many nats, among `others` so far behind."""
    nearest = min(behind, *others, behind)
    return math.exp(nearest - behind) / sum(math.exp(nearest - other) for other in [behind, *others])


def _names(plant: Plant, baseline: Plant) -> str:
    added = sorted(plant.active - baseline.active)
    return ", ".join(added) if added else "the re-fitted baseline"
