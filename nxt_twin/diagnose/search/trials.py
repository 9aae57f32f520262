"""The effects that may be added to a structure, each settled from the starts that suit it."""

from __future__ import annotations

import math
from collections.abc import Set
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Draft, Structure, is_mechanical
from nxt_twin.diagnose.search.cycles import at_half_the_cycles, at_whole_cycles
from nxt_twin.diagnose.search.drafts import LOSS_ITERATIONS, SLOW_ITERATIONS, STARTS_FOLLOWED, Drafts
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.diagnose.search.losing import chance_alone, lies_in_angle, losing, wandering
from nxt_twin.diagnose.search.onset import at_likeliest_onset, has_onset
from nxt_twin.diagnose.search.second_wave import with_second_wave
from nxt_twin.diagnose.search.settled import UNFITTED_NATS, Settled
from nxt_twin.diagnose.search.sharing import shared_anew
from nxt_twin.diagnose.search.standard import Standard
from nxt_twin.diagnose.search.weight import weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals


def addable_effects(plant: Plant, signals: Signals) -> list[Effect]:
    """The effects that `plant` lacks and could have, driven as it is.

    What comes on top of a plain term, as stiction does on friction, waits for that term: alone it is another law. Rows
    that came in clumps were not read quite evenly, which looks like lost counts and stale readings: neither is a cause
    there.
    """
    shows_counts = signals.quantum > 0.0 and not signals.clump_rows
    shows_stale = not signals.clump_rows
    superseded = {gone for effect in plant.effects for gone in effect.supersedes}
    return [
        effect
        for effect in plant.layout.effects
        if effect.id not in plant.active
        and effect.id not in superseded
        and _has_its_ground(effect, plant.active | superseded)
        and effect.takes(signals.input_kind)
        and (not effect.counted or shows_counts)
        and ("outlier" not in effect.terms or shows_stale)
    ]


def _has_its_ground(effect: Effect, there: Set[str]) -> bool:
    """Whether the term that `effect` comes on top of is `there`, if it comes on top of any."""
    above = effect.parameters[0].above
    return above is None or above[0] in there


@final
@dataclass(frozen=True)
class _Start:
    """A plant with an effect, and the noise from which it is to be settled."""

    effect: Effect
    plant: Plant
    noise: Noise


def _started(drafted: tuple[Effect, Draft], noise: Noise) -> _Start:
    """What was drafted, to be settled from `noise`."""
    effect, draft = drafted
    return _Start(effect, draft.fitted.plant, noise)


def _likeliest(settled: list[tuple[Effect, Structure]]) -> list[tuple[Effect, Structure]]:
    """Of each effect the likeliest structure, in the order of the effects' last ones."""
    best: dict[str, tuple[Effect, Structure]] = {}
    for effect, trial in settled:
        before = best.pop(effect.id, None)
        kept = trial if before is None or trial.fitted_cost < before[1].fitted_cost else before[1]
        best[effect.id] = (effect, kept)
    return list(best.values())


def _may_lead(trial: Structure, lowest: float) -> bool:
    """Whether friction shared anew may make `trial` likelier than one whose cost is the `lowest`, nats."""
    return trial.fitted_cost < lowest + EFFORT.shared_nats


@final
class Trials:
    """A search's candidates. Each way of settling them finds effects that the others overlook.

    Args:
        fits: asked for costs, drafts and starts.
        settled: keeps what was settled.
        standard: says how much an effect has to gain.
        drafts: the effects by what they promise.
    """

    def __init__(self, fits: Fits, settled: Settled, standard: Standard, drafts: Drafts) -> None:
        self._fits = fits
        self._settled = settled
        self._standard = standard
        self._drafts = drafts
        self._settle_suspected()

    def beside(self, best: Structure) -> list[tuple[Effect, Structure]]:
        """Every likely candidate added to `best`, settled, the likeliest of them under noise of their own."""
        needed = self._standard.needed(best)
        drafts = self._drafts.of(best, self.candidates(best.plant), EFFORT.drafted, EFFORT.promised * needed)
        if not drafts:
            return self._settled_each(self._restoring(best, set(), best.noise))
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
        settled = self._settled_from_each_side(best, cost, drafts, within)
        settled = [(effect, self._rested(best, trial)) for effect, trial in settled]
        lowest = min(trial.fitted_cost for _, trial in settled)
        in_reach = EFFORT.in_reach * max(best.fitted_cost - lowest, needed)
        settled = [
            (effect, self._waved(effect, trial) if trial.fitted_cost <= lowest else trial)
            for effect, trial in settled
        ]
        near = [one for one in settled if best.fitted_cost - one[1].fitted_cost > in_reach]
        anew = self._fits.abreast(
            lambda one: self._settled_anew(best, *one, shares=_may_lead(one[1], lowest)), near
        )
        better = {effect.id: trial for (effect, _), trial in zip(near, anew, strict=True)}
        return [(effect, better.get(effect.id, trial)) for effect, trial in settled]

    def _settled_from_each_side(
        self,
        best: Structure,
        cost: float,
        drafts: list[tuple[Effect, Draft]],
        within: list[tuple[Effect, Draft]],
    ) -> list[tuple[Effect, Structure]]:
        """The drafts `within` reach, and effects that no draft shows, settled: as many at once as may be."""
        leaders, starts = self._leaders(best, cost, within)
        listed = {effect.id for effect, _ in leaders} | {start.effect.id for start in starts}
        led = max(best.fitted_cost - trial.fitted_cost for _, trial in leaders)
        starts += self._rugged(best, cost, drafts, listed, led)
        listed |= {start.effect.id for start in starts}
        scattering = self._scattering(best, listed)
        starts += [*scattering, *self._stamped_late(best), *self._losing(best)]
        listed |= {start.effect.id for start in starts}
        starts += self._by_chance(best, listed)
        suspected = self._suspected(best, listed)
        listed |= {effect.id for effect, _ in suspected} | {start.effect.id for start in starts}
        leading = min((trial for _, trial in leaders), key=lambda one: one.fitted_cost)
        starts += self._restoring(best, listed, leading.noise)
        settled = _likeliest([*leaders, *self._settled_each(starts), *suspected])
        brief = {start.effect.id for start in scattering}
        return [one for one in settled if one[0].id not in brief or self._outlasts_a_poll(*one)]

    def _waved(self, effect: Effect, leading: Structure) -> Structure:
        """The likeliest trial; of a lag that wanders, with a second wave where that gains enough."""
        wanders = "pace" in effect.terms
        return with_second_wave(self._fits, self._settled, leading, effect) if wanders else leading

    def candidates(self, plant: Plant) -> list[Effect]:
        """The effects that may be added to `plant`, those left out that a search does without."""
        problem = self._fits.problem
        return [e for e in addable_effects(plant, problem.signals[0]) if e.id not in problem.without]

    def _settle_suspected(self) -> None:
        """Settle each effect that somebody leans to from the parameters as they were given.

        Where much is missing, the re-fitted baseline lies far away, and what is added to it may not find back.
        """
        problem = self._fits.problem
        noise = self._fits.first_noise()
        for effect in self.candidates(problem.plant):
            if effect.id in problem.leaning:
                start = self._fits.starts(effect)[0]
                self._settled.settle(problem.plant.with_effect(effect.id, start), noise)

    def _leaders(
        self, best: Structure, cost: float, drafts: list[tuple[Effect, Draft]]
    ) -> tuple[list[tuple[Effect, Structure]], list[_Start]]:
        """The first draft settled, with others that may come to gain what is needed, and more that may as well.

        The latter are starts: how much the first gains from its draft tells of them.
        """
        needed = self._standard.needed(best)

        def may_gain(one: tuple[Effect, Draft], lifted: float) -> bool:
            return lifted * (cost - one[1].cost) + EFFORT.slack_nats >= needed

        leader, others = drafts[0], drafts[1:]
        sure = [leader, *(one for one in others if may_gain(one, EFFORT.lifted))]
        settled = self._settled_each([_started(one, best.noise) for one in sure])
        promise, first = cost - leader[1].cost, settled[0][1]
        gain = best.fitted_cost + best.check_cost - first.fitted_cost - first.check_cost
        lifted = max(EFFORT.lifted, gain / promise) if promise > 0.0 else EFFORT.lifted
        more = [one for one in others if one not in sure and may_gain(one, lifted)]
        return settled, [_started(one, best.noise) for one in more]

    def _settled_each(self, starts: list[_Start]) -> list[tuple[Effect, Structure]]:
        """Each effect settled from its start."""
        settled = self._settled.settle_each([(start.plant, start.noise) for start in starts])
        return [(start.effect, trial) for start, trial in zip(starts, settled, strict=True)]

    def _rested(self, best: Structure, trial: Structure) -> Structure:
        """`trial`, settled once more under the noise of `best` where it simulates much nearer and is not likelier.

        Under a noise that has grown beside a gap or a stop, its fit has come to rest on the way to a likelier place.
        """
        weight = weigh(best, trial)
        stuck = weight.gain < 0.0 and weight.free_run_ratio < LIMITS.much_nearer
        return self._settled.settle(trial.plant, best.noise) if stuck else trial

    def _rugged(
        self,
        best: Structure,
        cost: float,
        drafts: list[tuple[Effect, Draft]],
        listed: set[str],
        led: float,
    ) -> list[_Start]:
        """Effects that promise enough and whose drafts are worse than `best`, to settle by a first guess of the noise.

        Enough beside the gain of the leader, too, which is `led`: another round follows once that one is in.

        Counts that are lost above a speed, or readings that are held, have a likelihood with many peaks under the small
        noise of a settled plant. Under a larger noise it leads to the highest. Beside found effects, more promises are
        broken, and each costs a fit: there it is tried beside late stamps only, whose noise is the smallest.
        """
        found = [e for e in best.plant.effects if e.id not in self._fits.problem.plant.active]
        if found and not any("outlier" in effect.terms for effect in found):
            return []
        needed = max(self._standard.needed(best), EFFORT.in_reach / EFFORT.lifted * led)
        noise = self._fits.first_noise()
        prospects = self._drafts.prospects(best, [effect for effect, _ in drafts])
        failed = [
            prospects[effect.id][0]
            for effect, draft in drafts
            if effect.id not in listed and draft.cost > cost and prospects[effect.id][0].gain > needed
        ]
        failed.sort(key=lambda prospect: -prospect.gain)
        return [_Start(prospect.effect, prospect.plant, noise) for prospect in failed[: EFFORT.rugged]]

    def _scattering(self, best: Structure, listed: set[str]) -> list[_Start]:
        """Effects that scatter readings, to settle where these are rough.

        No linear look shows them: the baseline's noise has taken the scatter in, and has to give it back first.
        """
        quantum = max(signals.quantum for signals in self._fits.problem.signals)
        fine = EFFORT.fine * quantum / math.sqrt(12.0)
        if best.noise.reading_std < fine or quantum <= 0.0:
            return []
        noise = replace(best.noise, reading_std=fine)
        starts = []
        for effect in self.candidates(best.plant):
            if not effect.holds_readings or effect.id in listed:
                continue
            plants = [best.plant.with_effect(effect.id, start) for start in self._fits.starts(effect)]
            costs = self._fits.costs(plants, noise)
            starts.append(_Start(effect, plants[int(np.argmin(costs))], noise))
        return starts

    def _stamped_late(self, best: Structure) -> list[_Start]:
        """A clock that stamps rows late by chance, to settle by a first guess of the noise.

        The noise of a plant without it has taken all of the scatter in, and a draft by it tells little.
        """
        noise = self._fits.first_noise()
        return [
            _Start(effect, plant, noise)
            for effect in self.candidates(best.plant)
            for plant in self._fits.stamped_late(best.plant, effect)
        ]

    def _losing(self, best: Structure) -> list[_Start]:
        """Lost counts beside what was found and lies in the angle, from the shares whose drafts come near."""
        found = [e for e in best.plant.effects if e.id not in self._fits.problem.plant.active]
        if not any(lies_in_angle(effect) for effect in found):
            return []
        counted = [effect for effect in self.candidates(best.plant) if effect.counted]
        return [
            _Start(effect, plant, best.noise) for effect in counted for plant in self._losses(best, effect)
        ]

    def _by_chance(self, best: Structure, listed: set[str]) -> list[_Start]:
        """Lost counts that are not `listed`, where their chance alone makes the readings likelier.

        A linear look shows what is lost on average, which other parameters take up.
        """
        counted = [e for e in self.candidates(best.plant) if e.counted and e.id not in listed]
        if not counted or best.noise.slip:
            return []
        gain, share, noise = chance_alone(self._fits, best)
        if gain < self._standard.needed(best):
            return []
        return [
            _Start(effect, wandering(self._fits, best, effect, share, noise), noise) for effect in counted
        ]

    def _losses(self, best: Structure, effect: Effect) -> list[Plant]:
        """`best` with the loss of counts that is `effect`, from the shares whose drafts come near; likeliest first.

        They are settled from where the drafts began: a rough fit beside a stop ends between peaks of the likelihood.
        """
        plants = losing(self._fits, best, effect)
        drafts = self._fits.abreast(
            lambda plant: self._fits.draft(plant, best.noise, iterations=LOSS_ITERATIONS), plants
        )
        most = self._fits.drafted_cost(best, best.noise) + UNFITTED_NATS
        near = [(draft.cost, place) for place, draft in enumerate(drafts) if draft.cost < most]
        return [plants[place] for _, place in sorted(near)[: EFFORT.losses]]

    def _outlasts_a_poll(self, effect: Effect, trial: Structure) -> bool:
        """Whether a recording's readings are held for longer than they are apart; jitter scatters them as well."""
        held_s = trial.plant.values[Slot(effect.id, effect.parameters[0].symbol)]
        return held_s > min(signals.interval_s for signals in self._fits.problem.signals)

    def _settled_anew(self, best: Structure, effect: Effect, trial: Structure, *, shares: bool) -> Structure:
        """The best of `trial` and of what other starts lead to, for effects with an onset, cycles or mechanical states.

        Their likelihood is rugged, the more so under the noise of a plant that lacks them, which forgives everything:
        so they are led from each start through a smaller unknown torque. Friction that may be a load's is shared anew
        where `shares` says that the effect may come to lead by it.
        """
        if has_onset(effect):
            moved = at_likeliest_onset(self._fits, trial.plant, effect, trial.noise)
            return trial if moved is trial.plant else self._settled.settle(moved, trial.noise)
        if not is_mechanical(effect):
            whole = at_whole_cycles(self._settled, trial, effect)
            return at_half_the_cycles(self._fits, self._settled, whole, effect)
        sober = replace(best.noise, disturbance_std=EFFORT.sober * best.noise.disturbance_std)
        prospects = self._drafts.prospects(best, [effect])[effect.id][:STARTS_FOLLOWED]
        drafts = self._fits.abreast(
            lambda prospect: self._fits.draft(prospect.plant, sober, iterations=SLOW_ITERATIONS), prospects
        )
        leading = min(drafts, key=lambda made: made.cost)
        elsewhere = leading.fitted.plant
        costs = self._fits.costs([elsewhere, trial.plant], trial.noise)
        near = costs[0] < costs[1] + UNFITTED_NATS
        anew = self._settled.settle(elsewhere, sober) if near else trial
        wanted = best.fitted_cost - anew.fitted_cost > self._standard.needed(best)
        return shared_anew(self._settled, best, anew, effect) if wanted and shares else anew

    def _suspected(self, best: Structure, listed: set[str]) -> list[tuple[Effect, Structure]]:
        """What was settled at first, where it adds one effect to `best` and is not `listed` already."""
        asked = [
            effect
            for effect in self.candidates(best.plant)
            if effect.id in self._fits.problem.leaning and effect.id not in listed
        ]
        known = [(effect, self._settled.with_effect(best.plant, effect)) for effect in asked]
        return [(effect, settled) for effect, settled in known if settled is not None]

    def _restoring(self, best: Structure, listed: set[str], noise: Noise) -> list[_Start]:
        """Effects to settle from the given numbers, where `best` has moved these far.

        A weak motor behind a stiff loop moves as one at half its duty does. No look from there shows that the duty is
        limited; a look from the given numbers does. Faults of the readings move no motor, and so none of its numbers.
        Drafts are made under `noise` of the likeliest candidate: the larger one of `best` forgives what is wrong.
        """
        if best.fitted.prior_cost < EFFORT.restoring_nats:
            return []
        given = self._fits.problem.plant.values
        home = best.plant.with_values({slot: x for slot, x in given.items() if slot in best.plant.values})
        fresh = [one for one in self.candidates(home) if not one.fault and one.id not in listed]
        drafts = self._drafts.of(self._fits.standing(home, noise), fresh, EFFORT.drafted)
        return [_started(one, noise) for one in drafts[: EFFORT.restoring]]
