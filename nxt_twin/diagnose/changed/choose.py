"""Which few differences account for what the sides do not share: forward, then backward."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import final

from nxt_twin.diagnose.changed.candidates import (
    PLAINER,
    ChangeCandidate,
    candidates_for,
    new_effects,
    plainer,
    promises,
    promising,
    rhythms,
)
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.changed.play import PlayTest
from nxt_twin.diagnose.changed.seen import is_as_well, is_seen
from nxt_twin.diagnose.changed.weighing import CLOSE_NATS, LOAD, WORSE, Weighing
from nxt_twin.diagnose.fitting.held import hold_came_in
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.trials import addable_effects as lacking
from nxt_twin.physics.effects.timing import SAMPLE_HOLD
from nxt_twin.physics.effects.transmission import BACKLASH

MOST_CHANGES = 3  # differing parameters and effects from which on a search adds no more
_TRIED = 5  # most promising candidates that each step of a search fits
_SECONDS = 3  # most promising candidates that are fitted beside each first one of a pair
_RIVALS = 3  # most promising candidates tried in a change's place; also exchanges pruned in a round, at most
_RHYTHMS = 12  # most promising ripples, by cycles a turn, that are fitted
_EXCHANGES = 2  # rounds of exchanges, at most
_BETTER_NATS = 1.0  # by which a rival has to be likelier in all readings before it is exchanged for a change
_BEGINNINGS = 3  # first steps from which one search grows, at most
_MOST_LACKING = 2  # effects in a row that both sides take in before the next change is tried, at most
_UNDER_LOAD = frozenset({"load_dependent_friction", "torque_saturation"})


@final
@dataclass(frozen=True)
class RivalChange:
    """A change that readings do not tell from a chosen one.

    Attributes:
        instead_of: of a chosen variable its index, of an effect its id.
        of: likewise, of the rival.
        joint: with the rival in that place.
        worth: what speaks for the rival in all readings, nats; negative where it is less likely.
    """

    instead_of: int | str
    of: int | str
    joint: JointFit
    worth: float


@final
@dataclass(frozen=True)
class Chosen:
    """The differences that earned their place.

    Attributes:
        joint: with them.
        nats: what each is worth beyond its penalty: of a variable by its index, of an effect by its id.
        lacking: ids of effects that would help on both sides, and are no change.
        rivals: changes that readings do not tell from these, the likeliest first.
    """

    joint: JointFit
    nats: dict[int | str, float]
    lacking: tuple[str, ...]
    rivals: tuple[RivalChange, ...] = ()


@final
class Chooser:
    """One choice between two sides."""

    def __init__(
        self,
        fitter: JointFitter,
        close: JointFitter,
        weighing: Weighing,
        free: JointFit,
        alone: JointFit,
    ) -> None:
        self._fitter, self._scale, self._free, self._alone = fitter, weighing.scale, free, alone
        self.weighing = weighing
        self._play = PlayTest(fitter, close, weighing, weighing.scale)
        self._signals = fitter.sides[1].jobs[0].signals
        before, after = ([job.signals for job in side.jobs] for side in fitter.sides)
        self._certain = {SAMPLE_HOLD.id} if hold_came_in(before, after) else set[str]()
        self._lacking: set[str] = set()
        self._tried: dict[int, tuple[JointFit, dict[int | str, list[tuple[JointFit, JointFit]]]]] = {}
        self._widened: dict[tuple[int, int, bool], tuple[JointFit, list[JointFit]]] = {}
        self._may_be_motor = True

    def chosen(self, joint: JointFit, progress: Progress) -> Chosen:
        """Add to `joint` while something earns its place, then take out what no longer does."""
        joint = self._completed(self._held(joint))
        best = self._pruned(joint)
        from_before = self._as_before(joint)
        for beginnings in (
            self._steps(joint),
            self._steps(from_before),
            self._rhythms(from_before),
            self._pairs(joint),
        ):
            best = self._searched(best, beginnings, progress)
            if self._is_finished(best.joint):
                break
        if best.joint.model.motor_constants:
            best = self._sparing_the_motor(joint, best, progress)
        if not self._certain and not self.weighing.matters(joint, best.joint):
            return Chosen(joint, {}, tuple(sorted(self._lacking)))
        return replace(best, lacking=tuple(sorted(self._lacking)), rivals=tuple(self._not_told(best)))

    def _held(self, joint: JointFit) -> JointFit:
        """`joint` with readings that are held after, where they repeat as none did before."""
        if not self._certain:
            return joint
        holds = [
            each
            for each in new_effects(self._fitter, joint.model, self._scale)
            if each.effect in self._certain
        ]
        models = [each.put(joint.model, self._scale) for each in holds]
        fits = [self._fitter.fit(model, model.moved_from(joint.model, joint.x)) for model in models]
        return min(fits, key=lambda each: each.cost)

    def _not_told(self, chosen: Chosen) -> list[RivalChange]:
        """What may stand in the place of one change: the readings, priors apart, favour neither clearly."""
        joint, found = chosen.joint, []
        doubtful = [one for one in chosen.nats if not self.weighing.is_companion(joint, one)]
        for each in (one for one in doubtful if one not in self._certain):
            for _, rival in self._rivals(joint, each):
                new = (set(rival.model.differs) | set(rival.model.effects)) - set(chosen.nats)
                if len(new) != 1 or rival.model.changes != joint.model.changes:
                    continue
                of = new.pop()
                if self._is_as_likely(joint, rival) and self.weighing.has_a_name(rival, of):
                    found.append(RivalChange(each, of, rival, self.weighing.worth(joint, rival)))
        return sorted(found, key=lambda one: -one.worth)

    def _is_as_likely(self, joint: JointFit, rival: JointFit) -> bool:
        """Whether the readings favour `joint` by less than a change has to gain."""
        behind = rival.cost + rival.check_cost - joint.cost - joint.check_cost
        more = rival.model.size - joint.model.size
        if sum(rival.check_rms) > max(WORSE * sum(joint.check_rms), 2.0 * self._fitter.tolerance):
            return False
        return behind + self.weighing.penalty * more < self.weighing.limit_nats

    def _searched(self, best: Chosen, beginnings: Iterator[JointFit], progress: Progress) -> Chosen:
        """`best`, or what is likelier and grows from one of the first `beginnings`."""
        start = best
        for number, step in enumerate(beginnings):
            found = self._exchanged(self._pruned(self._grown(step, progress)))
            found = self._plainly(self._loosened(self._plainly(found), progress))
            if self.weighing.worth(best.joint, found.joint) > 0.0:
                best = found
            if (best is not start and self._is_finished(best.joint)) or number + 1 == _BEGINNINGS:
                break
        return best

    def _sparing_the_motor(self, joint: JointFit, best: Chosen, progress: Progress) -> Chosen:
        """`best`, or what is likelier where the motor's constants stay as they were.

        Two changes of a load together often look like another winding, which then is the first step of a search.
        """
        self._may_be_motor = False
        for beginnings in (self._steps(joint), self._pairs(joint)):
            best = self._searched(best, beginnings, progress)
            if not best.joint.model.motor_constants:
                break
        self._may_be_motor = True
        return best

    def _as_before(self, joint: JointFit) -> JointFit:
        """`joint` with the numbers of the side before alone: a large change draws what both share far off."""
        return replace(joint, x=joint.model.moved_from(self._alone.model, self._alone.x))

    def _is_finished(self, joint: JointFit) -> bool:
        """Whether both sides are simulated about as well as the side before alone, and own plants gain no more."""
        fitter, alone = self._fitter, self._alone.check_rms[0]
        as_well = is_as_well(joint.check_rms, alone, fitter.tolerance, fitter.as_read)
        return as_well and self.weighing.net(joint, self._free) <= self.weighing.limit_nats

    def _grown(self, joint: JointFit, progress: Progress) -> JointFit:
        """`joint` with more changes, while each earns its place."""
        joint = self._closer(joint)
        while joint.model.changes < MOST_CHANGES:
            progress(f"trying what else may have changed; {joint.model.changes} so far")
            joint = self._completed(joint)
            better = next(self._steps(joint), None)
            if better is None:
                break
            joint = self._closer(better)
        return joint

    def _completed(self, joint: JointFit) -> JointFit:
        """`joint` with what the plant lacks on both sides, while that is likelier than any change.

        Otherwise the next likeliest change would stand for it.
        """
        for _ in range(_MOST_LACKING):
            first = next(iter(self._earned(joint, self._wider(joint, _TRIED))), None)
            common = None if first is None else self._on_both(joint, first)
            if common is None:
                break
            joint = common
        return joint

    def _closer(self, joint: JointFit) -> JointFit:
        """`joint` with what may hide behind another load: it is not fixed, or the motor yields under it."""
        if joint.model.moves_inertia:
            joint = self._play.passed(joint) or joint
        return self._under_load(joint)

    def _loosened(self, found: Chosen, progress: Progress) -> Chosen:
        """With a load behind play where close windows show it, and what shows beside it then; else without."""
        fixed = self._play.without(found.joint)
        if fixed is not None:
            return self._exchanged(self._pruned(fixed))
        moved = found.joint.model.moves_inertia or not self._is_finished(found.joint)
        loose = self._play.passed(found.joint) if moved else None
        return self._exchanged(self._pruned(self._grown(loose, progress))) if loose else found

    def _plainly(self, chosen: Chosen) -> Chosen:
        """`chosen` with what says a law's part with less, unless the readings speak loudly for the law.

        What the model lacks grows with a change: where friction is a little larger one way, and all of it
        triples, a law of unequal friction gains some nats beyond the friction that tripled.
        """
        for each in [one for one in chosen.nats if isinstance(one, str) and one not in self._certain]:
            for _, rival in self._rivals(chosen.joint, each):
                if _symbols(rival.model) - _symbols(chosen.joint.model) != {PLAINER.get(each)}:
                    continue
                if self.weighing.worth(rival, chosen.joint) < CLOSE_NATS:
                    return self._plainly(self._pruned(rival))
        return chosen

    def _under_load(self, joint: JointFit) -> JointFit:
        """With what only a heavier load shows, on both sides: otherwise the load makes up for what the motor yields."""
        if not {joint.model.ways[n].slot.symbol for n in joint.model.differs} & LOAD:
            return joint
        missing = [e for e in lacking(joint.model.after, self._signals) if e.id in _UNDER_LOAD]
        for effect in missing:
            model = joint.model.lacking(effect.id, starts_of(effect, self._scale)[0], self._scale)
            wider = self._fitter.fit(model, model.moved_from(joint.model, joint.x))
            if self.weighing.net(joint, wider) > self.weighing.limit_nats and self.weighing.lasts(
                joint, wider
            ):
                self._lacking.add(effect.id)
                joint = wider
        return joint

    def _exchanged(self, chosen: Chosen) -> Chosen:
        """Put another in the place of each change where that is likelier: the first that helps may be the wrong one."""
        for _ in range(_EXCHANGES):
            joint = chosen.joint
            shown = {*self._certain, BACKLASH.id}  # closer windows showed play
            exchangeable = [each for each in chosen.nats if each not in shown]
            rivals = [rival for each in exchangeable for rival in self._rivals(joint, each)]
            as_near = [pair for pair in rivals if sum(pair[1].check_rms) < WORSE * sum(joint.check_rms)]
            better = [(self.weighing.worth(joint, rival), bare, rival) for bare, rival in as_near]
            better = [each for each in better if each[0] > _BETTER_NATS]
            better.sort(key=lambda each: -each[0])
            own = (rival for _, bare, rival in better if self._on_both(bare, rival) is None)
            pruned = [self._pruned(rival) for rival in islice(own, _RIVALS)]
            if not pruned:
                break
            chosen = max(pruned, key=lambda each: self.weighing.worth(joint, each.joint))
        return chosen

    def _rivals(self, joint: JointFit, each: int | str) -> list[tuple[JointFit, JointFit]]:
        """`joint` without one change, and with others in its place.

        What was found is kept by the fit itself, which `_tried` holds.
        """
        _, known = self._tried.setdefault(id(joint), (joint, {}))
        if each not in known:
            known[each] = self._rivals_anew(joint, each)
        return known[each]

    def _rivals_anew(self, joint: JointFit, each: int | str) -> list[tuple[JointFit, JointFit]]:
        model = self._without(joint.model, each)
        bare = self._fitter.fit(model, model.moved_from(joint.model, joint.x))
        found = []
        others = self._promising(bare, _RIVALS)
        if isinstance(each, str):
            said_with_less = plainer(self._fitter, bare, each, self._scale)
            others += [other for other in said_with_less if other not in others]
        for other in others:
            wider = other.put(model, self._scale)
            if wider.changes <= MOST_CHANGES and (wider.differs, wider.effects) != (
                joint.model.differs,
                joint.model.effects,
            ):
                found.append(self._fitter.fit(wider, wider.moved_from(model, bare.x)))
        return [(bare, rival) for rival in found]

    def _promising(self, joint: JointFit, most: int) -> list[ChangeCandidate]:
        """What promises most beside `joint`, best first; beside no change each parameter too.

        A promise is a straight line's. It misleads where a first change is large.
        """
        every = candidates_for(self._fitter, joint.model, self._scale)
        if not self._may_be_motor:
            ways = joint.model.ways
            every = [each for each in every if not any(ways[n].is_motor_constant for n in each.slots)]
        best = promising(self._fitter, joint, every, self._scale, most)
        if joint.model.changes:
            return best
        return [*best, *(each for each in every if each.effect is None and each not in best)]

    def _wider(self, joint: JointFit, most: int) -> list[JointFit]:
        """`joint` with each of what promises most."""
        key = id(joint), most, self._may_be_motor
        if key not in self._widened:
            models = [each.put(joint.model, self._scale) for each in self._promising(joint, most)]
            fits = [self._fitter.fit(model, model.moved_from(joint.model, joint.x)) for model in models]
            self._widened[key] = joint, fits
        return self._widened[key][1]

    def _steps(self, joint: JointFit) -> Iterator[JointFit]:
        """`joint` with one change more: all that earn their place, the likeliest first."""
        found = self._earned(joint, self._wider(joint, _TRIED))
        yield from (tried for tried in found if self._on_both(joint, tried) is None)

    def _rhythms(self, joint: JointFit) -> Iterator[JointFit]:
        """`joint` with commutation ripple, from the likeliest numbers of cycles a turn: one of many fits by chance."""
        every = rhythms(self._fitter, joint.model, self._scale)
        promised = sorted(promises(self._fitter, joint, every, self._scale), key=lambda item: -item[0])
        models = [each.put(joint.model, self._scale) for _, each in promised[:_RHYTHMS]]
        fits = [self._fitter.fit(model, model.moved_from(joint.model, joint.x)) for model in models]
        loud = [tried for tried in self._earned(joint, fits) if self.weighing.is_loud(joint, tried)]
        yield from (tried for tried in loud if self._on_both(joint, tried) is None)

    def _pairs(self, joint: JointFit) -> Iterator[JointFit]:
        """`joint` with two changes more, which earn their place together: alone, one may look worse than none."""
        firsts = self._wider(joint, _TRIED)
        pairs = [(first, pair) for first in firsts for pair in self._wider(first, _SECONDS)]
        bare = {id(pair): first for first, pair in pairs}
        found = self._earned(joint, [pair for _, pair in pairs if pair.model.changes <= MOST_CHANGES])
        yield from (pair for pair in found if self._on_both(bare[id(pair)], pair) is None)

    def _earned(self, joint: JointFit, found: list[JointFit]) -> list[JointFit]:
        """Those that earn their place, the likeliest first."""
        limit = self.weighing.limit_nats
        found = [
            each
            for each in found
            if self.weighing.net(joint, each) > limit and self.weighing.lasts(joint, each)
        ]
        return sorted(found, key=lambda each: -self.weighing.worth(joint, each))

    def _on_both(self, joint: JointFit, tried: JointFit) -> JointFit | None:
        """`joint` with the new effect of `tried` on both sides, where it explains more there.

        The plant lacks such an effect, and always did.
        """
        new = set(tried.model.effects) - set(joint.model.effects)
        if not new:
            return None
        effect = next(iter(new))
        plant = tried.model.plant_at(tried.x, after=True)
        own = {slot.symbol: value for slot, value in plant.values.items() if slot.owner == effect}
        model = joint.model.differing(tried.model.differs).lacking(effect, own, self._scale)
        common = self._fitter.fit(model, model.moved_from(tried.model, tried.x))
        spoils = common.check_rms[0] > max(WORSE * tried.check_rms[0], self._fitter.tolerance)
        together, alone = (self.weighing.plain(joint, fit) - fit.check_cost for fit in (common, tried))
        if together <= alone or spoils:
            return None
        self._lacking.add(effect)
        return common

    def _pruned(self, joint: JointFit) -> Chosen:
        while True:
            nats: dict[int | str, float] = {}
            weakest: tuple[float, JointFit] | None = None
            moved: list[int | str] = [*joint.model.differs, *joint.model.effects]
            for each in moved:
                model = self._without(joint.model, each)
                simpler = self._fitter.fit(model, model.moved_from(joint.model, joint.x))
                nats[each] = self.weighing.net(simpler, joint)
                earned = nats[each] >= self.weighing.keeping(joint, each)
                stays = each in self._certain or (earned and is_seen(self._fitter, simpler, joint))
                if not stays and (weakest is None or nats[each] < weakest[0]):
                    weakest = (nats[each], simpler)
            if weakest is None:
                return Chosen(joint, nats, tuple(sorted(self._lacking)))
            joint = weakest[1]

    def _without(self, model: Model, each: int | str) -> Model:
        return model.alike(each) if isinstance(each, int) else model.without_effect(each, self._scale)


def _symbols(model: Model) -> set[str | None]:
    """What differs in a model: symbols of parameters, ids of effects."""
    return {*(model.ways[n].slot.symbol for n in model.differs), *model.effects}
