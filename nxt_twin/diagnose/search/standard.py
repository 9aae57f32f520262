"""The tests that an effect must pass to enter a structure, or to stay in it."""

from __future__ import annotations

import math
from collections.abc import Set
from typing import final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.diagnose.search.notable import (
    is_hardly_too_small,
    is_notable,
    is_repeated,
    is_told_from_jitter,
    is_too_small,
)
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.diagnose.search.weight import Weight, weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot

_PERIODS = ("per_turn", "period_s")
"""End the names of parameters that say how often an effect repeats."""

_OUR_OWN = "our own"
"""Begins the source of a law that nobody published."""


@final
class Standard:
    """What one search asks of effects, beside its `baseline` and what it has `settled`.

    `unnamed` are the ids of effects that came in without a name, which the search adds to.
    """

    def __init__(
        self, fits: Fits, baseline: Structure, settled: Settled, unnamed: Set[str] = frozenset()
    ) -> None:
        self._fits = fits
        self._baseline = baseline
        self._settled = settled
        self._unnamed = unnamed
        self._loud: set[str] = set()

    @property
    def loud(self) -> frozenset[str]:
        """The effects that have a name whatever their size."""
        return frozenset(self._loud)

    def hear(self, best: Structure, trial: Structure, effect: Effect) -> bool:
        """Give `effect`, which is too small for a name, one where `trial` needs it loudly; whether it has one now.

        Motors of one make differ by less than its notable size, and the readings of this one by much more than matters.
        What replaces a plain term has none: it gains what that term does, and the term has a name of its own.
        """
        if effect.supersedes or not is_hardly_too_small(trial.plant, effect, self._fits.problem.scale):
            return False
        weight = weigh(best, trial)
        errs = best.free_run_rms[0] > LIMITS.odd_tolerances * self._fits.problem.tolerance
        loud = weight.gain > LIMITS.many_nats and weight.check_gain > LIMITS.loud_nats
        if errs and loud and weight.free_run_ratio < LIMITS.much_nearer and not weight.runs_worse:
            self._loud.add(effect.id)
        return effect.id in self._loud

    def is_notable(self, best: Structure, effect_id: str) -> bool:
        """Whether the effect is large enough in `best` to have a name."""
        if effect_id in self._loud:
            return True
        problem, effect = self._fits.problem, best.plant.layout.effect(effect_id)
        repeats = not problem.by_windows or is_repeated(best.plant, effect, problem.signals)
        held = is_told_from_jitter(best.plant, effect, problem.signals)
        return (
            repeats and held and is_notable(best.plant, effect, problem.scale) and self.is_late(best, effect)
        )

    def is_too_small(self, best: Structure, effect_id: str) -> bool:
        """Whether the effect is told in `best`, and too small for a name."""
        return is_too_small(best.plant, best.plant.layout.effect(effect_id), self._fits.problem.scale)

    def is_late(self, best: Structure, effect: Effect) -> bool:
        """Whether readings that `effect` doubts are late by more than a stamp's jitter."""
        if "outlier" not in effect.terms:
            return True
        poll_s = max(signals.interval_s for signals in self._fits.problem.signals)
        return self._fits.lateness_s(best) > LIMITS.late_polls * poll_s

    def worth_it(self, effect: Effect, weight: Weight, best: Structure) -> bool:
        """Whether `effect` is to be added to `best`: it must also gain more than the form of those in it may lack.

        What readings that count for little explain does not count: there is no form in them that could be wrong. Beside
        other effects, counts that are lost have to bring simulations nearer, as what is lost on average does. Their
        chance alone takes any drift that the form of the others leaves.
        """
        found = best.plant.active - self._baseline.plant.active - self._unnamed
        by_chance = effect.counted and found and weight.free_run_ratio > LIMITS.nearer
        return self.likelier(effect, weight, best) and not weight.runs_worse and not by_chance

    def likelier(self, effect: Effect, weight: Weight, best: Structure) -> bool:
        """Whether it earns its place, were there no free runs that are worse; much nearer ones ask for less."""
        chosen = _choice_nats(effect)
        if not weight.borne_out(LIMITS.check_nats):
            return False
        needed = self.needed(best, weight) + chosen - min(self.belief(effect), 0.0)
        clear = weight.gain > needed or (
            weight.gain > LIMITS.half * needed
            and weight.total > LIMITS.altogether * needed
            and weight.check_gain > LIMITS.check_nats
        )
        nearer = (
            weight.free_run_ratio < LIMITS.much_nearer and weight.gain > 0.0 and not self._is_silent(best)
        )
        return clear or (
            nearer
            and weight.total
            > max(LIMITS.silent_nats, LIMITS.much_nearer_share * self._explained(best)) + chosen
        )

    def lasts(self, weight: Weight, simpler: Structure, richer: Structure) -> bool:
        """Whether `richer` is not just better in a few moments, as a period can be that fits three turns a little off.

        Asked of what comes on top of other effects: where the laws of those are a little off, such moments come about.
        Where a simulation hardly errs, one odd second is no missing physics either, however loud. What brings given
        numbers back need gain nothing there: the numbers in their place simulate as well. Nor need friction that acts
        where a motor turns back. What recurs may gain in few moments, but in more than one.
        """
        first = simpler.plant.active - self._unnamed == self._baseline.plant.active - self._unnamed
        errs = simpler.free_run_rms[0] > LIMITS.odd_tolerances * self._fits.problem.tolerance
        returns = _turns_back(weight, simpler, richer)
        asked = not errs and not weight.restores and not returns
        if asked and self._fits.gained_elsewhere(simpler, richer) < LIMITS.gain_nats:
            return False
        return (
            first
            or returns
            or _recurs(weight, simpler, richer)
            or weight.gain > LIMITS.many_nats
            or self._fits.moments_gained(simpler, richer) > LIMITS.few_moments
        )

    def needed(self, best: Structure, weight: Weight | None = None) -> float:
        """Gain that a further effect needs; more where the error that `best` leaves is below the tolerance.

        Unless the effect's `weight` shows that a simulation gets much nearer still, or that checking readings call for
        it as well. Nor is more asked of what brings given numbers back: what priors gain is no matter of the form of
        other laws.
        """
        if weight is not None and weight.restores:
            return LIMITS.gain_nats
        explained = self._explained(best)
        silent = self._is_silent(best)
        share = LIMITS.form_share * explained
        borne_out = weight is not None and weight.check_gain > LIMITS.recurring_nats
        if silent and weight is not None and not borne_out and weight.free_run_ratio > LIMITS.nearer:
            idle = min((weight.free_run_ratio - LIMITS.nearer) / (1.0 - LIMITS.nearer), 1.0)
            further = LIMITS.idle_share * (self._baseline.fitted_cost - best.fitted_cost)
            share += idle * max(further - share, 0.0)
        least = LIMITS.silent_nats if silent else LIMITS.gain_nats
        if self._fits.problem.by_windows:
            least = LIMITS.windows_nats
        return max(least, share)

    def _explained(self, best: Structure) -> float:
        """What `best` has gained over the baseline, nats, but for readings that it doubts."""
        return self._doubting(best).fitted_cost - best.fitted_cost

    def _is_silent(self, best: Structure) -> bool:
        """Whether what `best` leaves does not matter to a simulation of two seconds."""
        return best.free_run_rms[0] <= self._fits.problem.tolerance

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

    def belief(self, effect: Effect) -> float:
        """The log prior odds of an effect, nats.

        A term that most plant files state is likely missing where a file leaves it out. Where windows alone
        decide, few readings are independent. A free curve, which stands for many mechanisms, then gives way
        to a known mechanism that it cannot be told from.
        """
        first = effect.parameters[0]
        stated = effect.plain and (first.frozen or math.isfinite(first.doubt))
        own = self._fits.problem.by_windows and effect.source.startswith(_OUR_OWN)
        return LIMITS.left_out_nats * stated - LIMITS.rival_nats * own + effect.commoner_nats

    def leaning(self, effect: Effect) -> float:
        """What speaks for an effect before these readings do, nats."""
        return self.belief(effect) + self._fits.problem.leaning.get(effect.id, 0.0)


def _turns_back(weight: Weight, simpler: Structure, richer: Structure) -> bool:
    """Whether `richer` adds friction where a motor slows and turns back, which it may do once, and it is borne out."""
    turns_back = all({"low_speed", "reversal"} <= {*effect.shows} for effect in _new(simpler, richer))
    return turns_back and weight.check_gain > LIMITS.gain_nats


def _recurs(weight: Weight, simpler: Structure, richer: Structure) -> bool:
    """Whether checking readings and a nearer simulation bear out what `richer` adds, so that it acts in other moments.

    A period that is a little off may fit checking readings too, as they lie in the same turn.
    """
    new = _new(simpler, richer)
    repeats = any(p.name.endswith(_PERIODS) for effect in new for p in effect.parameters)
    return not repeats and weight.check_gain > LIMITS.recurring_nats and weight.free_run_ratio < 1.0


def _new(simpler: Structure, richer: Structure) -> list[Effect]:
    """The effects that `richer` adds."""
    return [effect for effect in richer.plant.effects if effect.id not in simpler.plant.active]


def _choice_nats(effect: Effect) -> float:
    """What the best of many separate likelihood peaks gains by chance, as those of a search for a period are."""
    return sum(math.log(len(p.starts)) for p in effect.parameters[1:] if len(p.starts) >= EFFORT.comb)


def keeps_its_place(weight: Weight, needed: float) -> bool:
    """Whether an effect that is in stays, given the nats `needed`."""
    return weight.total > needed and weight.borne_out(0.0) and not weight.runs_worse
