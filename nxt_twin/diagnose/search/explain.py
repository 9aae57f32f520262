"""Find the effects that the data call for: forward one at a time, then backward, then what could stand in."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.coincidence import are_twins, as_twin, coincidence_nats
from nxt_twin.diagnose.search.drafts import Drafts
from nxt_twin.diagnose.search.latency import after_latency
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.diagnose.search.play import may_hide_play, play_behind
from nxt_twin.diagnose.search.rivals import Rival, likelier_structure, simulates_worse
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.diagnose.search.standard import Standard, keeps_its_place
from nxt_twin.diagnose.search.trials import Trials
from nxt_twin.diagnose.search.untaken import Untaken
from nxt_twin.diagnose.search.weight import Weight, weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.plant import Plant

Ranked = tuple[Effect, Weight, Structure]
"""An effect, what speaks for it, and the structure with it."""


@final
@dataclass(frozen=True)
class Explanation:
    """The result of the search.

    Attributes:
        baseline: the re-fitted baseline.
        best: the structure with every effect that earned its place.
        found: those effects, the weightiest first, each with what speaks for keeping it.
        rivals: for each found effect, others tried in its place, best first.
        refused: effects that came nearest to being added at the end, best first, each with its weight and the structure
            with it.
        unnamed: effects in `best` that are too small for a name, and explain more than a larger one would.
        loud: ids of effects that have a name though they are small.
        untaken: structures that were settled and led on, and which the search did not grow from, the best first.
    """

    baseline: Structure
    best: Structure
    found: tuple[tuple[Effect, Weight], ...]
    rivals: dict[str, tuple[Rival, ...]]
    refused: tuple[Ranked, ...]
    unnamed: tuple[Effect, ...] = ()
    loud: frozenset[str] = frozenset()
    untaken: tuple[Structure, ...] = ()


def explain(
    fits: Fits, baseline: Structure, progress: Progress, known: Sequence[Structure] = ()
) -> Explanation:
    """Search the library for what the re-fitted `baseline` lacks; `known` structures are not settled from worse."""
    search = _Search(fits, baseline, known=known)
    begin = search.begun()
    return _exchanged(search, begin, search.grown(begin, progress), progress)


def explain_anew(
    fits: Fits, explanation: Explanation, begin: Structure, progress: Progress
) -> Explanation | None:
    """As `explain`, from a way that the search for `explanation` did not go; None where it leads to nothing likelier.

    Where more than one thing is missing, the likeliest first step may lead away from all of them.
    """
    search = _Search(fits, explanation.baseline, {effect.id for effect in explanation.unnamed})
    grown = search.grown(begin, progress, steps=1)
    if weigh(explanation.best, grown[0]).total < LIMITS.gain_nats:
        return None
    if grown[0] is not begin:
        grown = search.grown(grown[0], progress)
    return _exchanged(search, begin, grown, progress)


def _exchanged(
    search: _Search, begin: Structure, grown: tuple[Structure, tuple[Ranked, ...]], progress: Progress
) -> Explanation:
    """What was `grown` from `begin`, with each effect exchanged for a likelier one as long as there are any."""
    grown_from = [begin]
    best, refused = grown
    found, rivals = search.placed(best, progress)
    while better := likelier_structure(rivals):
        best = search.pruned(better)
        # Where what grows is exchanged again and again, the likelier stays as it is, so that no worse one is named.
        again = len(grown_from) > EFFORT.exchanges or _is_among(best, grown_from)
        if not again:
            grown_from.append(best)
            best, refused = search.grown(best, progress)
        found, rivals = search.placed(best, progress)
        if again:
            break
    return Explanation(
        search.baseline, best, found, rivals, refused, search.unnamed(best), search.loud, search.untaken(best)
    )


@final
class _Search:
    """One search: the structures that were settled on the way are kept, so that none is fitted twice."""

    def __init__(
        self,
        fits: Fits,
        baseline: Structure,
        unnamed: Iterable[str] = (),
        known: Sequence[Structure] = (),
    ) -> None:
        self.baseline = baseline
        self._fits = fits
        self._settled = Settled(fits, baseline, known)
        self._unnamed = set(unnamed)
        self._standard = Standard(fits, baseline, self._settled, self._unnamed)
        self._drafts = Drafts(fits)
        self._trials = Trials(fits, self._settled, self._standard, self._drafts)
        self._tried: list[Effect] = []
        self._untaken = Untaken()
        self._tried_play: dict[frozenset[str], float] = {}

    def begun(self) -> Structure:
        """The baseline, with the host's latency if the readings tell of any."""
        candidates = self._trials.candidates(self.baseline.plant)
        begun = after_latency(self._fits, self._settled, self.baseline, candidates)
        self._unnamed.update(begun.plant.active - self.baseline.plant.active)
        return begun

    def grown(
        self, best: Structure, progress: Progress, steps: float = math.inf
    ) -> tuple[Structure, tuple[Ranked, ...]]:
        """Add effects to `best` while one earns its place, in so many steps at most; what came near is noted."""
        been = {best.plant.active: best.fitted_cost}
        refused: tuple[Ranked, ...] = ()
        while steps > 0 and len(best.plant.active - self.baseline.plant.active) < LIMITS.most_effects:
            steps -= 1
            progress(f"trying each effect with {_names(best.plant, self.baseline.plant)}")
            ranked, smaller = self._forward(best)
            self._tried.extend(effect for effect, _, _ in ranked if effect not in self._tried)
            refused = tuple(ranked)
            added = self._added(best, ranked, smaller) if ranked else self._rounded_off(best, smaller)
            if (
                added is None
                or added.fitted_cost > been.get(added.plant.active, math.inf) - EFFORT.better_nats
            ):
                return best, refused  # the latter where what is added is taken out again: round and round
            been[added.plant.active] = added.fitted_cost
            best = added
        return best, tuple(one for one in refused if one[0].id not in best.plant.active)

    def _added(self, best: Structure, ranked: list[Ranked], smaller: list[Ranked]) -> Structure | None:
        """`best` with the leader of `ranked`, if that earns its place, or with two that do together.

        Where one of the `smaller` explains more, that one comes first: what it explains names no other.
        """
        effect, weight, trial = ranked[0]
        if self._standard.worth_it(effect, weight, best):
            return self._with_smaller(best, ranked[0], smaller) or self._still_worth_it(
                self.pruned(trial), effect
            )
        both = next((both for both in map(partial(self._with_another, best), ranked) if both), None)
        return both or self._rounded_off(best, smaller)

    def _rounded_off(self, best: Structure, smaller: list[Ranked]) -> Structure | None:
        """`best` with the first of the `smaller`, where no larger effect helps and it brings a simulation much nearer.

        Effects that were found keep their names then: what they leave has a known cause, if a small one.
        """
        found = best.plant.active - self.baseline.plant.active - self._unnamed
        for effect, weight, trial in smaller[:1]:
            told = self._standard.worth_it(effect, weight, best) and self._standard.lasts(weight, best, trial)
            if found and told and weight.free_run_ratio < LIMITS.nearer:
                self._unnamed.add(effect.id)
                return trial
        return None

    def _with_smaller(self, best: Structure, leader: Ranked, smaller: list[Ranked]) -> Structure | None:
        """`best` with the first of the `smaller`, if that is worth it and clearly likelier than the `leader`.

        A name is withheld only for as much as an effect needs to be found at all.
        """
        for effect, weight, trial in smaller[:1]:
            *rank, total = self._rank(effect, weight, trial, best)
            *named, least = self._rank(*leader, best)
            ahead = rank >= named and total > least + LIMITS.gain_nats
            if ahead and self._standard.worth_it(effect, weight, best):
                self._unnamed.add(effect.id)
                return trial
        return None

    def _with_another(self, best: Structure, tried: tuple[Effect, Weight, Structure]) -> Structure | None:
        """`best` with an effect that nothing but free runs speaks against, and another beside which these do not.

        Where more than one thing is missing, the one that is right may well run further off by itself.
        """
        effect, weight, trial = tried
        if not (self._standard.likelier(effect, weight, best) and self._standard.lasts(weight, best, trial)):
            return None
        ranked, _ = self._forward(trial)
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
            added = sorted(best.plant.active - self.baseline.plant.active)
            lesser = self._fits.abreast(partial(self._settled.without, best), added)
            for effect_id, simpler in zip(added, lesser, strict=True):
                weight = weigh(simpler, best)
                kept = self._is_told(best, effect_id) and keeps_its_place(
                    weight, LIMITS.keep_nats + self._belief_in_what_returns(simpler, best)
                )
                if not kept and (weakest is None or weight.total < weakest[0]):
                    weakest = (weight.total, simpler)
            if weakest is None:
                return best
            best = weakest[1]

    def _is_told(self, best: Structure, effect_id: str) -> bool:
        """Whether the effect is large enough in `best` for a name, or came in without one."""
        unnamed = effect_id in self._unnamed and self._standard.is_too_small(best, effect_id)
        return unnamed or self._standard.is_notable(best, effect_id)

    def unnamed(self, best: Structure) -> tuple[Effect, ...]:
        """The effects in `best` that came in without a name, and have not grown to one."""
        own = sorted(self._unnamed & (best.plant.active - self.baseline.plant.active))
        return tuple(
            best.plant.layout.effect(each) for each in own if not self._standard.is_notable(best, each)
        )

    def _belief_in_what_returns(self, simpler: Structure, best: Structure) -> float:
        """What speaks beforehand for the plain effects that come back where one that replaced them goes."""
        back = simpler.plant.active - best.plant.active - self.baseline.plant.active
        return sum(self._standard.belief(best.plant.layout.effect(effect_id)) for effect_id in back)

    def untaken(self, best: Structure) -> tuple[Structure, ...]:
        """What led on, and `best` did not come from."""
        return self._untaken.beside(best)

    @property
    def loud(self) -> frozenset[str]:
        """The effects that have a name whatever their size."""
        return self._standard.loud

    def placed(
        self, best: Structure, progress: Progress
    ) -> tuple[tuple[tuple[Effect, Weight], ...], dict[str, tuple[Rival, ...]]]:
        """The effects in `best` that have a name, and the rivals of each."""
        progress("checking each effect's place")
        found = self.found(best)
        return found, {effect.id: self.rivals(best, effect) for effect, _ in found}

    def found(self, best: Structure) -> tuple[tuple[Effect, Weight], ...]:
        """The effects in `best` that have a name, the weightiest first."""
        unnamed = {effect.id for effect in self.unnamed(best)}
        weighed = [
            (best.plant.layout.effect(effect_id), weigh(self._settled.without(best, effect_id), best))
            for effect_id in sorted(best.plant.active - self.baseline.plant.active - unnamed)
        ]
        return tuple(sorted(weighed, key=lambda item: -item[1].total))

    def rivals(self, best: Structure, effect: Effect) -> tuple[Rival, ...]:
        """Effects that were near at some time, are declared confusable or promise much, put in `effect`'s place."""
        bare = self._settled.without(best, effect.id)
        near = {*effect.confusable_with, *(other.id for other in self._tried)}
        allowed = [e for e in self._trials.candidates(bare.plant) if e.id != effect.id and e.id in near]
        self._settle_twins(best, effect, allowed)
        self._settle_play(best, effect, allowed)
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

    def _settle_twins(self, best: Structure, effect: Effect, others: list[Effect]) -> None:
        """Settle what moves a motor as `effect` does from where it does so, unless it has come as far by itself."""
        for twin in (as_twin(best.plant, effect, other) for other in others):
            known = twin and self._settled.like(twin)
            behind = known.fitted_cost - best.fitted_cost if known else math.inf
            if twin and behind > LIMITS.rival_nats:
                self._settled.settle(twin, best.noise)

    def _settle_play(self, best: Structure, effect: Effect, others: list[Effect]) -> None:
        """Settle play from where a shaft that twists has brought the masses, once for each that is likelier."""
        for other in (one for one in others if may_hide_play(effect, one)):
            if best.fitted_cost < self._tried_play.get(best.plant.active, math.inf) - EFFORT.better_nats:
                self._tried_play[best.plant.active] = best.fitted_cost
                self._settled.settle_each(play_behind(self._fits, best, other))

    def _rival(self, best: Structure, effect: Effect, other: Effect, trial: Structure) -> Rival:
        """`other` in the place of `effect`."""
        weight = weigh(trial, best)
        twins = are_twins(best.plant, effect, other) or are_twins(trial.plant, other, effect)
        alike = twins and abs(weight.total) < LIMITS.twin_nats
        told = 0.0 if alike and abs(weight.total) > LIMITS.told_nats else weight.total
        behind = told + self._favour(best, effect) - self._favour(trial, other)
        worse = weight.restores or (not alike and simulates_worse(best, trial, other))
        return Rival(other, behind, trial, worse, twins)

    def _forward(self, best: Structure) -> tuple[list[Ranked], list[Ranked]]:
        """Every candidate added to `best`, ranked; apart from these those that are too small for a name.

        What brings a plain term with it that the baseline lacks is not small: that term would lose its name to it.
        """
        settled = self._trials.beside(best)
        for effect, trial in settled:
            if best is self.baseline and self._standard.is_too_small(trial, effect.id):
                self._standard.hear(best, trial, effect)
        named = [one for one in settled if self._standard.is_notable(one[1], one[0].id)]
        self._untaken.note(best, named)
        smaller = [
            (effect, trial)
            for effect, trial in settled
            if self.baseline.plant.active.issuperset(effect.supersedes)
            and self._standard.is_too_small(trial, effect.id)
            and effect.id not in self._standard.loud
        ]
        return self._ranked(best, named), self._ranked(best, smaller)

    def _ranked(self, best: Structure, settled: list[tuple[Effect, Structure]]) -> list[Ranked]:
        """What was `settled` beside `best`, the likeliest first.

        What restores given numbers comes before, unless another is likelier and brings simulations much nearer: numbers
        that a missing load has moved come back in part with anything.
        """
        ranked = [(effect, weigh(best, trial), trial) for effect, trial in settled]
        ranks = {effect.id: self._rank(effect, weight, trial, best) for effect, weight, trial in ranked}
        nearer = [ranks[effect.id] for effect, weight, _ in ranked if _is_much_nearer(weight)]
        nearest = max((total for _, lasts, _, total in nearer if lasts), default=-math.inf)

        def key(one: Ranked) -> tuple[bool, bool, bool, float]:
            worth_it, lasts, restores, total = ranks[one[0].id]
            first = restores and (_is_much_nearer(one[1]) or total > nearest)
            return worth_it, lasts, first, total

        return sorted(ranked, key=key, reverse=True)

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


def _is_much_nearer(weight: Weight) -> bool:
    return weight.free_run_ratio < LIMITS.much_nearer


def _is_among(structure: Structure, others: list[Structure]) -> bool:
    """Whether one of `others` has these effects and is about as likely, so that it grows into what it grew into."""
    return any(
        one.plant.active == structure.plant.active
        and abs(one.fitted_cost - structure.fitted_cost) <= EFFORT.better_nats
        for one in others
    )


def _names(plant: Plant, baseline: Plant) -> str:
    added = sorted(plant.active - baseline.active)
    return ", ".join(added) if added else "the re-fitted baseline"
