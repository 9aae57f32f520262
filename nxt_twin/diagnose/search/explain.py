"""Find the effects that the data call for: forward one at a time, then backward, then what could stand in."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import final

from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.fitting.structure import Structure, is_mechanical
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.search.drafting import Draft, draft_costs, drafted
from nxt_twin.diagnose.search.drafts import SLOW_ITERATIONS, STARTS_FOLLOWED, Drafts
from nxt_twin.diagnose.search.moments import moments_gained
from nxt_twin.diagnose.search.notable import is_notable, is_repeated
from nxt_twin.diagnose.search.settled import UNFITTED_NATS, Settled
from nxt_twin.diagnose.search.weight import Weight, free_run_ratio, weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals

Progress = Callable[[str], None]

MOST_EFFECTS = 4
GAIN_NATS = 8.0  # of which some three pay for having thirty effects to choose from
SILENT_NATS = 12.0  # where a simulation of two seconds is off by less than the tolerance already
CHECK_NATS = 2.0
KEEP_NATS = 3.0
RIVAL_NATS = 6.0
SWAP_NATS = 1.0
_RIVAL_RATIO = 1.03  # of errors in free runs, from which they speak against a likelier rival

_DRAFTED = 10
_PROMISED = 0.1  # of the gain that is needed: with less of it no linear look at an effect has been that wrong
_RIVALS_DRAFTED = 4
_SHORT_LIST = 5
_LEADING = 2
_SLACK_NATS = 10.0  # what is further behind, unfitted or under other noise, does not come out ahead
_LIFTED = 2.5  # so many times a draft's gain other noise makes of it, or what it made of the leading one's
_MANY_NATS = 100.0
_FEW_MOMENTS = (
    3.5  # from which alone less than that may come by chance: a few turns a little off, and a period found
)
_COMB = 5  # so many starts are separate peaks
_BETTER_NATS = 1.0
_SETTLED_SHARE = 0.1  # of the best draft's gain: with less of it, other noise makes no winner of a draft
_IN_REACH = 0.25  # of the best draft's gain: slow effects with so much of it are settled too
_RIVAL_REACH_NATS = 40.0
_FAR_REACH_NATS = 400.0  # for the only rival to show how far behind it is
_EXCHANGES = 4
_SOBER = 0.3
_LEFT_OUT_NATS = 3.0
_OUR_OWN = "our own"  # the source of a law that nobody published
_FORM_SHARE = 0.04  # of what is explained: an equation a fifth off in size leaves so much


@final
@dataclass(frozen=True)
class Rival:
    """An effect that does nearly as well in the place of a found one.

    Attributes:
        effect: the other.
        behind: nats, negative if it is likelier.
        structure: with it in the found one's place.
        simulates_worse: whether free runs over checking readings speak against it.
    """

    effect: Effect
    behind: float
    structure: Structure
    simulates_worse: bool

    @property
    def doubt_nats(self) -> float:
        """How far behind it counts when beliefs are shared: where likelihood and simulation disagree, a tie."""
        return max(self.behind, 0.0) if self.simulates_worse else self.behind


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


def explain(fitter: Fitter, baseline: Structure, progress: Progress) -> Explanation:
    """Search the library for what the re-fitted `baseline` lacks."""
    search = _Search(fitter, baseline)
    best = baseline
    for _ in range(_EXCHANGES + 1):
        best, refused = search.grown(best, progress)
        progress("checking each effect's place")
        found = search.found(best)
        rivals = {effect.id: search.rivals(best, effect) for effect, _ in found}
        better = _better(rivals)
        if better is None:
            break
        best = search.pruned(better)
    else:  # what grows is exchanged again and again: the likelier stays as it is, so that no worse one is named
        found = search.found(best)
        rivals = {effect.id: search.rivals(best, effect) for effect, _ in found}
    return Explanation(baseline, best, found, rivals, refused)


def candidates(plant: Plant, signals: Signals) -> list[Effect]:
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

    def __init__(self, fitter: Fitter, baseline: Structure) -> None:
        self._fitter = fitter
        self._baseline = baseline
        self._settled = Settled(fitter, baseline)
        self._drafts = Drafts(fitter)
        self._tried: list[Effect] = []
        self._settle_suspected()

    def _settle_suspected(self) -> None:
        """Settle each effect that somebody leans to from the parameters as they were given.

        Where much is missing, the re-fitted baseline lies far away, and what is added to it may not find back.
        """
        problem = self._fitter.problem
        noise = first_guess(problem.plant, problem.signals, problem.scale.torque)
        for effect in self._candidates(problem.plant):
            if effect.id in problem.leaning:
                start = starts_of(effect, problem.scale)[0]
                self._settled.settle(problem.plant.with_effect(effect.id, start), noise)

    def grown(
        self, best: Structure, progress: Progress
    ) -> tuple[Structure, tuple[tuple[Effect, Weight], ...]]:
        """Add effects to `best` while one earns its place; what came near is noted."""
        been = {best.plant.active: best.fitted_cost}
        refused: tuple[tuple[Effect, Weight], ...] = ()
        while len(best.plant.active - self._baseline.plant.active) < MOST_EFFECTS:
            progress(f"trying each effect with {_names(best.plant, self._baseline.plant)}")
            ranked = self._forward(best)
            self._tried.extend(effect for effect, _, _ in ranked if effect not in self._tried)
            refused = tuple((effect, weight) for effect, weight, _ in ranked)
            added = self._added(best, ranked) if ranked else None
            if added is None or added.fitted_cost > been.get(added.plant.active, math.inf) - _BETTER_NATS:
                return best, refused  # the latter where what is added is taken out again: round and round
            been[added.plant.active] = added.fitted_cost
            best = added
        return best, tuple(one for one in refused if one[0].id not in best.plant.active)

    def _added(self, best: Structure, ranked: list[tuple[Effect, Weight, Structure]]) -> Structure | None:
        """`best` with the leader of `ranked`, if that earns its place, or with two that do together."""
        effect, weight, trial = ranked[0]
        if self._worth_it(effect, weight, best):
            return self._still_worth_it(self.pruned(trial), effect)
        return next((both for both in map(partial(self._with_another, best), ranked) if both), None)

    def _with_another(self, best: Structure, tried: tuple[Effect, Weight, Structure]) -> Structure | None:
        """`best` with an effect that nothing but free runs speaks against, and another beside which these do not.

        Where more than one thing is missing, the one that is right may well run further off by itself.
        """
        effect, weight, trial = tried
        if not (self._likelier(effect, weight, best) and self._lasts(weight, best, trial)):
            return None
        ranked = self._forward(trial)
        if not ranked or not self._worth_it(ranked[0][0], ranked[0][1], trial):
            return None
        both = self.pruned(ranked[0][2])
        kept = {effect.id, ranked[0][0].id} <= both.plant.active
        kept = kept and all(self._still_worth_it(both, one) is both for one in (effect, ranked[0][0]))
        return both if kept and not weigh(best, both).runs_worse else None

    def _still_worth_it(self, added: Structure, effect: Effect) -> Structure:
        """`added`, or less `effect` where that, settled anew from there, comes too near to add it."""
        if effect.id not in added.plant.active:
            return added
        simpler = self._settled.without(added, effect.id)
        weight = weigh(simpler, added)
        kept = self._worth_it(effect, weight, simpler) and self._lasts(weight, simpler, added)
        return added if kept else simpler

    def pruned(self, best: Structure) -> Structure:
        """Take out, one at a time, effects that no longer earn their place."""
        while True:
            weakest: tuple[float, Structure] | None = None
            for effect_id in sorted(best.plant.active - self._baseline.plant.active):
                simpler = self._settled.without(best, effect_id)
                weight = weigh(simpler, best)
                kept = self._is_notable(best, effect_id) and _keeps_its_place(
                    weight, KEEP_NATS + self._belief_in_what_returns(simpler, best)
                )
                if not kept and (weakest is None or weight.total < weakest[0]):
                    weakest = (weight.total, simpler)
            if weakest is None:
                return best
            best = weakest[1]

    def _is_notable(self, best: Structure, effect_id: str) -> bool:
        problem, effect = self._fitter.problem, best.plant.layout.effect(effect_id)
        repeats = not problem.by_windows or is_repeated(best.plant, effect, problem.signals)
        return repeats and is_notable(best.plant, effect, problem.scale)

    def _belief(self, effect: Effect) -> float:
        """What speaks for an effect beforehand, nats.

        What plant files mostly state is likely missing where left out. Where windows alone decide, and few readings
        are independent, a curve of our own that stands for many mechanisms is no match for one that is known.
        """
        first = effect.parameters[0]
        stated = effect.plain and (first.frozen or math.isfinite(first.doubt))
        own = self._fitter.problem.by_windows and effect.source.startswith(_OUR_OWN)
        return _LEFT_OUT_NATS * (stated - own)

    def _belief_in_what_returns(self, simpler: Structure, best: Structure) -> float:
        """What speaks beforehand for the plain effects that come back where one that replaced them goes."""
        back = simpler.plant.active - best.plant.active - self._baseline.plant.active
        return sum(self._belief(best.plant.layout.effect(effect_id)) for effect_id in back)

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
        equal = self._drafts.cost(best, bare.noise)
        for rank, (other, draft) in enumerate(self._drafts.of(bare, fresh, _RIVALS_DRAFTED)):
            reach = _RIVAL_REACH_NATS if rank or known else _FAR_REACH_NATS
            if draft.cost - equal < reach:
                trial = self._settled.settle(draft.fitted.plant, bare.noise)
                rivals.append(self._rival(best, effect, other, trial))
        notable = [one for one in rivals if self._is_notable(one.structure, one.effect.id)]
        return tuple(sorted(notable, key=lambda rival: rival.doubt_nats)[:_SHORT_LIST])

    def _rival(self, best: Structure, effect: Effect, other: Effect, trial: Structure) -> Rival:
        """`other` in the place of `effect`."""
        behind = weigh(trial, best).total + self._leaning(effect) - self._leaning(other)
        return Rival(other, behind, trial, free_run_ratio(best, trial) >= _RIVAL_RATIO)

    def _forward(self, best: Structure) -> list[tuple[Effect, Weight, Structure]]:
        """Every candidate added to `best`, the likeliest of them under noise of their own, ranked."""
        needed = self._needed(best)
        drafts = self._drafts.of(best, self._candidates(best.plant), _DRAFTED, _PROMISED * needed)
        if not drafts:
            return []
        cost = self._drafts.cost(best, best.noise)
        leading = max(cost - drafts[0][1].cost, 0.0)
        within = [
            (effect, draft)
            for rank, (effect, draft) in enumerate(drafts)
            if rank == 0
            or (rank < _LEADING and draft.cost - cost < _SLACK_NATS)
            or (rank < _SHORT_LIST and cost - draft.cost > _SETTLED_SHARE * leading)
            or (effect.states and cost - draft.cost > _IN_REACH * leading)
        ]
        settled = self._leaders(best, cost, within)
        settled += self._suspected(best, {effect.id for effect, _ in settled})
        lowest = min(trial.fitted_cost for _, trial in settled)
        in_reach = _IN_REACH * max(best.fitted_cost - lowest, needed)
        ranked = []
        for effect, trial in settled:
            if best.fitted_cost - trial.fitted_cost > in_reach:
                trial = self._settled_anew(best, effect, trial)
            if self._is_notable(trial, effect.id):
                ranked.append((effect, weigh(best, trial), trial))
        ranked.sort(key=lambda item: self._rank(item[0], item[1], item[2], best), reverse=True)
        return ranked

    def _rank(
        self, effect: Effect, weight: Weight, trial: Structure, best: Structure
    ) -> tuple[bool, bool, float]:
        worth_it = self._worth_it(effect, weight, best)
        return worth_it, worth_it and self._lasts(weight, best, trial), weight.total + self._leaning(effect)

    def _leaders(
        self, best: Structure, cost: float, drafts: list[tuple[Effect, Draft]]
    ) -> list[tuple[Effect, Structure]]:
        """Drafts settled, the first for certain, the others where they may come to gain what is needed."""
        needed, lifted = self._needed(best), _LIFTED
        settled: list[tuple[Effect, Structure]] = []
        for effect, draft in drafts:
            promise = cost - draft.cost
            if settled and lifted * promise + _SLACK_NATS < needed:
                continue
            trial = self._settled.settle(draft.fitted.plant, best.noise)
            if not settled and promise > 0.0:
                gain = best.fitted_cost + best.check_cost - trial.fitted_cost - trial.check_cost
                lifted = max(lifted, gain / promise)
            settled.append((effect, trial))
        return settled

    def _settled_anew(self, best: Structure, effect: Effect, trial: Structure) -> Structure:
        """The best of `trial` and of what other starts lead to, for effects with mechanical states of their own.

        Their likelihood is rugged, the more so under the noise of a plant that lacks them, which forgives everything:
        so they are led from each start through a smaller unknown torque.
        """
        if not is_mechanical(effect):
            return trial
        sober = replace(best.noise, disturbance_std=_SOBER * best.noise.disturbance_std)
        prospects = self._drafts.prospects(best, [effect])[effect.id][:STARTS_FOLLOWED]
        drafts = [drafted(self._fitter, p.plant, sober, iterations=SLOW_ITERATIONS) for p in prospects]
        leading = min(drafts, key=lambda made: made.cost)
        elsewhere = leading.fitted.plant
        costs = draft_costs(self._fitter, [elsewhere, trial.plant], trial.noise)
        return self._settled.settle(elsewhere, sober) if costs[0] < costs[1] + UNFITTED_NATS else trial

    def _worth_it(self, effect: Effect, weight: Weight, best: Structure) -> bool:
        """Whether `effect` is to be added to `best`: it must also gain more than the form of those in it may lack.

        What readings that count for little explain does not count: there is no form in them that could be wrong.
        """
        return self._likelier(effect, weight, best) and not weight.runs_worse

    def _likelier(self, effect: Effect, weight: Weight, best: Structure) -> bool:
        """The same, were there no free runs."""
        needed = self._needed(best) + _choice_nats(effect) - min(self._belief(effect), 0.0)
        return weight.gain > needed and weight.borne_out(CHECK_NATS)

    def _lasts(self, weight: Weight, simpler: Structure, richer: Structure) -> bool:
        """Whether `richer` is not just better in a few moments, as a period can be that fits three turns a little off.

        Asked of what comes on top of other effects: where the laws of those are a little off, such moments come about.
        """
        first = simpler.plant.active == self._baseline.plant.active
        return (
            first or weight.gain > _MANY_NATS or moments_gained(self._fitter, simpler, richer) > _FEW_MOMENTS
        )

    def _needed(self, best: Structure) -> float:
        """What a further effect has to gain; more where what `best` leaves does not matter to a simulation."""
        explained = self._doubting(best).fitted_cost - best.fitted_cost
        silent = best.free_run_rms[0] <= self._fitter.problem.tolerance
        return max(SILENT_NATS if silent else GAIN_NATS, _FORM_SHARE * explained)

    def _doubting(self, best: Structure) -> Structure:
        """The baseline with just those of `best`'s effects that doubt readings."""
        plant = self._baseline.plant
        for effect in best.plant.effects:
            if "outlier" in effect.terms and effect.id not in plant.active:
                shares = {p.symbol: best.plant.values[Slot(effect.id, p.symbol)] for p in effect.parameters}
                plant = plant.with_effect(effect.id, shares)
        if plant.active == self._baseline.plant.active:
            return self._baseline
        return self._settled.like(plant) or self._settled.settle(plant, best.noise)

    def _suspected(self, best: Structure, listed: set[str]) -> list[tuple[Effect, Structure]]:
        """What was settled at first, where it adds one effect to `best` and is not `listed` already."""
        asked = [
            effect
            for effect in self._candidates(best.plant)
            if effect.id in self._fitter.problem.leaning and effect.id not in listed
        ]
        known = [(effect, self._settled.with_effect(best.plant, effect)) for effect in asked]
        return [(effect, settled) for effect, settled in known if settled is not None]

    def _leaning(self, effect: Effect) -> float:
        """What speaks for an effect before these readings do, nats."""
        return self._belief(effect) + self._fitter.problem.leaning.get(effect.id, 0.0)

    def _candidates(self, plant: Plant) -> list[Effect]:
        problem = self._fitter.problem
        return [e for e in candidates(plant, problem.signals[0]) if e.id not in problem.without]


def _better(rivals: dict[str, tuple[Rival, ...]]) -> Structure | None:
    """The structure with one effect exchanged that is clearly likelier, and simulates no worse."""
    beating = [
        rival
        for near in rivals.values()
        for rival in near
        if rival.behind < -SWAP_NATS and not rival.simulates_worse
    ]
    return min(beating, key=lambda rival: rival.behind).structure if beating else None


def _choice_nats(effect: Effect) -> float:
    """What the best of many separate likelihood peaks gains by chance, as those of a search for a period are."""
    return sum(math.log(len(p.starts)) for p in effect.parameters[1:] if len(p.starts) >= _COMB)


def _keeps_its_place(weight: Weight, needed: float) -> bool:
    return weight.total > needed and weight.borne_out(0.0) and not weight.runs_worse


def probability(behind: float, others: list[float]) -> float:
    """The share of belief for a structure `behind` the best by so many nats, among `others` so far behind."""
    nearest = min(behind, *others, behind)
    return math.exp(nearest - behind) / sum(math.exp(nearest - other) for other in [behind, *others])


def _names(plant: Plant, baseline: Plant) -> str:
    added = sorted(plant.active - baseline.active)
    return ", ".join(added) if added else "the re-fitted baseline"
