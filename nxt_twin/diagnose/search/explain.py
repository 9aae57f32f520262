"""Find the effects that the data call for: forward one at a time, then backward, then what could stand in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Draft, Structure, is_mechanical
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.coincidence import coincidence_nats
from nxt_twin.diagnose.search.drafts import SLOW_ITERATIONS, STARTS_FOLLOWED, Drafts
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.diagnose.search.onset import at_likeliest_onset, has_onset
from nxt_twin.diagnose.search.rivals import Rival, likelier_structure, simulates_worse
from nxt_twin.diagnose.search.settled import UNFITTED_NATS, Settled
from nxt_twin.diagnose.search.standard import Standard, keeps_its_place
from nxt_twin.diagnose.search.weight import RESTORED_NATS, Weight, weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals


@final
@dataclass(frozen=True)
class Explanation:
    """The result of the search.

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


def explain(fits: Fits, baseline: Structure, progress: Progress) -> Explanation:
    """Search the library for what the re-fitted `baseline` lacks."""
    search = _Search(fits, baseline)
    best = baseline
    for _ in range(EFFORT.exchanges + 1):
        best, refused = search.grown(best, progress)
        progress("checking each effect's place")
        found = search.found(best)
        rivals = {effect.id: search.rivals(best, effect) for effect, _ in found}
        better = likelier_structure(rivals)
        if better is None:
            break
        best = search.pruned(better)
    else:  # what grows is exchanged again and again: the likelier stays as it is, so that no worse one is named
        found = search.found(best)
        rivals = {effect.id: search.rivals(best, effect) for effect, _ in found}
    return Explanation(baseline, best, found, rivals, refused)


def addable_effects(plant: Plant, signals: Signals) -> list[Effect]:
    """The effects that `plant` lacks and could have, driven as it is."""
    superseded = {gone for effect in plant.effects for gone in effect.supersedes}
    return [
        effect
        for effect in plant.layout.effects
        if effect.id not in plant.active
        and effect.id not in superseded
        and effect.takes(signals.input_kind)
        and (not effect.counted or signals.quantum > 0.0)
    ]


@final
class _Search:
    """One search: the structures that were settled on the way are kept, so that none is fitted twice."""

    def __init__(self, fits: Fits, baseline: Structure) -> None:
        self._fits = fits
        self._baseline = baseline
        self._settled = Settled(fits, baseline)
        self._standard = Standard(fits, baseline, self._settled)
        self._drafts = Drafts(fits)
        self._tried: list[Effect] = []
        self._settle_suspected()

    def _settle_suspected(self) -> None:
        """Settle each effect that somebody leans to from the parameters as they were given.

        Where much is missing, the re-fitted baseline lies far away, and what is added to it may not find back.
        """
        problem = self._fits.problem
        noise = self._fits.first_noise()
        for effect in self._candidates(problem.plant):
            if effect.id in problem.leaning:
                start = self._fits.starts(effect)[0]
                self._settled.settle(problem.plant.with_effect(effect.id, start), noise)

    def grown(
        self, best: Structure, progress: Progress
    ) -> tuple[Structure, tuple[tuple[Effect, Weight], ...]]:
        """Add effects to `best` while one earns its place; what came near is noted."""
        been = {best.plant.active: best.fitted_cost}
        refused: tuple[tuple[Effect, Weight], ...] = ()
        while len(best.plant.active - self._baseline.plant.active) < LIMITS.most_effects:
            progress(f"trying each effect with {_names(best.plant, self._baseline.plant)}")
            ranked = self._forward(best)
            self._tried.extend(effect for effect, _, _ in ranked if effect not in self._tried)
            refused = tuple((effect, weight) for effect, weight, _ in ranked)
            added = self._added(best, ranked) if ranked else None
            if (
                added is None
                or added.fitted_cost > been.get(added.plant.active, math.inf) - EFFORT.better_nats
            ):
                return best, refused  # the latter where what is added is taken out again: round and round
            been[added.plant.active] = added.fitted_cost
            best = added
        return best, tuple(one for one in refused if one[0].id not in best.plant.active)

    def _added(self, best: Structure, ranked: list[tuple[Effect, Weight, Structure]]) -> Structure | None:
        """`best` with the leader of `ranked`, if that earns its place, or with two that do together."""
        effect, weight, trial = ranked[0]
        if self._standard.worth_it(effect, weight, best):
            return self._still_worth_it(self.pruned(trial), effect)
        return next((both for both in map(partial(self._with_another, best), ranked) if both), None)

    def _with_another(self, best: Structure, tried: tuple[Effect, Weight, Structure]) -> Structure | None:
        """`best` with an effect that nothing but free runs speaks against, and another beside which these do not.

        Where more than one thing is missing, the one that is right may well run further off by itself.
        """
        effect, weight, trial = tried
        if not (self._standard.likelier(effect, weight, best) and self._standard.lasts(weight, best, trial)):
            return None
        ranked = self._forward(trial)
        if not ranked or not self._standard.worth_it(ranked[0][0], ranked[0][1], trial):
            return None
        both = self.pruned(ranked[0][2])
        kept = {effect.id, ranked[0][0].id} <= both.plant.active
        kept = kept and all(self._still_worth_it(both, one) is both for one in (effect, ranked[0][0]))
        if kept:
            return both if not weigh(best, both).runs_worse else None
        return self._alone(best, both, (effect, ranked[0][0]))

    def _alone(self, best: Structure, left: Structure, tried: tuple[Effect, Effect]) -> Structure | None:
        """`left`, to which two that were tried together have led, if it has one of them and that is worth it."""
        added = left.plant.active - best.plant.active
        for effect in tried:
            worth_it = added == {effect.id} and self._standard.worth_it(effect, weigh(best, left), best)
            if worth_it:
                return left
        return None

    def _still_worth_it(self, added: Structure, effect: Effect) -> Structure:
        """`added`, or less `effect` where that, settled anew from there, comes too near to add it."""
        if effect.id not in added.plant.active:
            return added
        simpler = self._settled.without(added, effect.id)
        weight = weigh(simpler, added)
        kept = self._standard.worth_it(effect, weight, simpler) and self._standard.lasts(
            weight, simpler, added
        )
        return added if kept else simpler

    def pruned(self, best: Structure) -> Structure:
        """Take out, one at a time, effects that no longer earn their place."""
        while True:
            weakest: tuple[float, Structure] | None = None
            for effect_id in sorted(best.plant.active - self._baseline.plant.active):
                simpler = self._settled.without(best, effect_id)
                weight = weigh(simpler, best)
                kept = self._standard.is_notable(best, effect_id) and keeps_its_place(
                    weight, LIMITS.keep_nats + self._belief_in_what_returns(simpler, best)
                )
                if not kept and (weakest is None or weight.total < weakest[0]):
                    weakest = (weight.total, simpler)
            if weakest is None:
                return best
            best = weakest[1]

    def _belief_in_what_returns(self, simpler: Structure, best: Structure) -> float:
        """What speaks beforehand for the plain effects that come back where one that replaced them goes."""
        back = simpler.plant.active - best.plant.active - self._baseline.plant.active
        return sum(self._standard.belief(best.plant.layout.effect(effect_id)) for effect_id in back)

    def found(self, best: Structure) -> tuple[tuple[Effect, Weight], ...]:
        """The effects in `best`, the weightiest first."""
        weighed = [
            (best.plant.layout.effect(effect_id), weigh(self._settled.without(best, effect_id), best))
            for effect_id in sorted(best.plant.active - self._baseline.plant.active)
        ]
        return tuple(sorted(weighed, key=lambda item: -item[1].total))

    def rivals(self, best: Structure, effect: Effect) -> tuple[Rival, ...]:
        """Effects that were near at some time, are declared confusable or promise much, put in `effect`'s place."""
        bare = self._settled.without(best, effect.id)
        near = {*effect.confusable_with, *(other.id for other in self._tried)}
        allowed = [e for e in self._candidates(bare.plant) if e.id != effect.id and e.id in near]
        known = {e.id: settled for e in allowed if (settled := self._settled.with_effect(bare.plant, e))}
        rivals = [self._rival(best, effect, e, known[e.id]) for e in allowed if e.id in known]
        fresh = [e for e in allowed if e.id not in known]
        equal = self._fits.drafted_cost(best, bare.noise)
        for rank, (other, draft) in enumerate(self._drafts.of(bare, fresh, EFFORT.rivals_drafted)):
            reach = EFFORT.rival_reach_nats if rank or known else EFFORT.far_reach_nats
            if draft.cost - equal < reach:
                trial = self._settled.settle(draft.fitted.plant, bare.noise)
                rivals.append(self._rival(best, effect, other, trial))
        notable = [one for one in rivals if self._standard.is_notable(one.structure, one.effect.id)]
        return tuple(sorted(notable, key=lambda rival: rival.doubt_nats)[: EFFORT.short_list])

    def _rival(self, best: Structure, effect: Effect, other: Effect, trial: Structure) -> Rival:
        """`other` in the place of `effect`."""
        weight = weigh(trial, best)
        behind = weight.total + self._favour(best, effect) - self._favour(trial, other)
        return Rival(other, behind, trial, weight.restores or simulates_worse(best, trial, other))

    def _forward(self, best: Structure) -> list[tuple[Effect, Weight, Structure]]:
        """Every candidate added to `best`, the likeliest of them under noise of their own, ranked."""
        needed = self._standard.needed(best)
        drafts = self._drafts.of(best, self._candidates(best.plant), EFFORT.drafted, EFFORT.promised * needed)
        if not drafts:
            return self._ranked(best, self._restoring(best, set()))
        cost = self._fits.drafted_cost(best, best.noise)
        leading = max(cost - drafts[0][1].cost, 0.0)
        within = [
            (effect, draft)
            for rank, (effect, draft) in enumerate(drafts)
            if rank == 0
            or (rank < EFFORT.leading and draft.cost - cost < EFFORT.slack_nats)
            or (rank < EFFORT.short_list and cost - draft.cost > EFFORT.settled_share * leading)
            or (effect.states and cost - draft.cost > EFFORT.in_reach * leading)
        ]
        settled = [*self._leaders(best, cost, within), *self._scattering(best, [e for e, _ in within])]
        settled += self._suspected(best, {effect.id for effect, _ in settled})
        settled += self._restoring(best, {effect.id for effect, _ in settled})
        lowest = min(trial.fitted_cost for _, trial in settled)
        in_reach = EFFORT.in_reach * max(best.fitted_cost - lowest, needed)
        anew = [
            (
                effect,
                self._settled_anew(best, effect, trial)
                if best.fitted_cost - trial.fitted_cost > in_reach
                else trial,
            )
            for effect, trial in settled
        ]
        return self._ranked(best, anew)

    def _ranked(
        self, best: Structure, settled: list[tuple[Effect, Structure]]
    ) -> list[tuple[Effect, Weight, Structure]]:
        """Those of `settled` that are large enough for a name, the likeliest first."""
        ranked = [
            (effect, weigh(best, trial), trial)
            for effect, trial in settled
            if self._standard.is_notable(trial, effect.id)
        ]
        ranked.sort(key=lambda item: self._rank(item[0], item[1], item[2], best), reverse=True)
        return ranked

    def _rank(
        self, effect: Effect, weight: Weight, trial: Structure, best: Structure
    ) -> tuple[bool, bool, bool, float]:
        worth_it = self._standard.worth_it(effect, weight, best)
        return (
            worth_it,
            worth_it and self._standard.lasts(weight, best, trial),
            worth_it
            and weight.restores,  # first: what readings gain far from the given numbers may be another law's
            weight.total + self._favour(trial, effect),
        )

    def _favour(self, structure: Structure, effect: Effect) -> float:
        """What speaks for `effect` beside the readings, at the size that it has in `structure`, nats."""
        return self._standard.leaning(effect) - coincidence_nats(structure.plant, effect)

    def _leaders(
        self, best: Structure, cost: float, drafts: list[tuple[Effect, Draft]]
    ) -> list[tuple[Effect, Structure]]:
        """Drafts settled, the first for certain, the others where they may come to gain what is needed."""
        needed, lifted = self._standard.needed(best), EFFORT.lifted
        settled: list[tuple[Effect, Structure]] = []
        for effect, draft in drafts:
            promise = cost - draft.cost
            if settled and lifted * promise + EFFORT.slack_nats < needed:
                continue
            trial = self._settled.settle(draft.fitted.plant, best.noise)
            if not settled and promise > 0.0:
                gain = best.fitted_cost + best.check_cost - trial.fitted_cost - trial.check_cost
                lifted = max(lifted, gain / promise)
            settled.append((effect, trial))
        return settled

    def _scattering(self, best: Structure, known: list[Effect]) -> list[tuple[Effect, Structure]]:
        """Effects that scatter readings, settled where these are rough.

        No linear look shows them: the baseline's noise has taken the scatter in, and has to give it back first.
        """
        quantum = max(signals.quantum for signals in self._fits.problem.signals)
        fine = EFFORT.fine * quantum / math.sqrt(12.0)
        if best.noise.reading_std < fine or quantum <= 0.0:
            return []
        noise = replace(best.noise, reading_std=fine)
        settled = []
        for effect in self._candidates(best.plant):
            if "scatter" not in effect.terms or effect in known:
                continue
            plants = [best.plant.with_effect(effect.id, start) for start in self._fits.starts(effect)]
            costs = self._fits.costs(plants, noise)
            trial = self._settled.settle(plants[int(np.argmin(costs))], noise)
            if self._outlasts_a_poll(trial, effect):
                settled.append((effect, trial))
        return settled

    def _outlasts_a_poll(self, trial: Structure, effect: Effect) -> bool:
        """Whether readings are held for longer than they are apart; the jitter of a link scatters them as well."""
        held_s = trial.plant.values[Slot(effect.id, effect.parameters[0].symbol)]
        return held_s > max(signals.interval_s for signals in self._fits.problem.signals)

    def _settled_anew(self, best: Structure, effect: Effect, trial: Structure) -> Structure:
        """The best of `trial` and of what other starts lead to, for effects with an onset or mechanical states.

        Their likelihood is rugged, the more so under the noise of a plant that lacks them, which forgives everything:
        so they are led from each start through a smaller unknown torque.
        """
        if has_onset(effect):
            moved = at_likeliest_onset(self._fits, trial.plant, effect, trial.noise)
            return trial if moved is trial.plant else self._settled.settle(moved, trial.noise)
        if not is_mechanical(effect):
            return trial
        sober = replace(best.noise, disturbance_std=EFFORT.sober * best.noise.disturbance_std)
        prospects = self._drafts.prospects(best, [effect])[effect.id][:STARTS_FOLLOWED]
        drafts = [self._fits.draft(p.plant, sober, iterations=SLOW_ITERATIONS) for p in prospects]
        leading = min(drafts, key=lambda made: made.cost)
        elsewhere = leading.fitted.plant
        costs = self._fits.costs([elsewhere, trial.plant], trial.noise)
        return self._settled.settle(elsewhere, sober) if costs[0] < costs[1] + UNFITTED_NATS else trial

    def _suspected(self, best: Structure, listed: set[str]) -> list[tuple[Effect, Structure]]:
        """What was settled at first, where it adds one effect to `best` and is not `listed` already."""
        asked = [
            effect
            for effect in self._candidates(best.plant)
            if effect.id in self._fits.problem.leaning and effect.id not in listed
        ]
        known = [(effect, self._settled.with_effect(best.plant, effect)) for effect in asked]
        return [(effect, settled) for effect, settled in known if settled is not None]

    def _restoring(self, best: Structure, listed: set[str]) -> list[tuple[Effect, Structure]]:
        """Effects settled from the given numbers, where `best` has moved these far.

        A weak motor behind a stiff loop moves as one at half its duty does. No look from there shows that the duty is
        limited; a look from the given numbers does.
        """
        if best.fitted.prior_cost < RESTORED_NATS:
            return []
        given = self._fits.problem.plant.values
        home = best.plant.with_values({slot: x for slot, x in given.items() if slot in best.plant.values})
        drafts = self._drafts.of(
            self._fits.standing(home, best.noise), self._candidates(home), EFFORT.restoring
        )
        return [
            (effect, self._settled.settle(draft.fitted.plant, best.noise))
            for effect, draft in drafts
            if effect.id not in listed
        ]

    def _candidates(self, plant: Plant) -> list[Effect]:
        problem = self._fits.problem
        return [e for e in addable_effects(plant, problem.signals[0]) if e.id not in problem.without]


def _names(plant: Plant, baseline: Plant) -> str:
    added = sorted(plant.active - baseline.active)
    return ", ".join(added) if added else "the re-fitted baseline"
