"""Which few differences account for what the sides do not share: forward, then backward."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.changed.candidates import candidates_for, promising
from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.physics.parameter import Scale

MOST_CHANGES = 3
_TRIED = 5
_RIVALS = 3
_EXCHANGES = 2
_BETTER_NATS = 1.0
_LAW_NATS = 3.0
_MAKE_NATS = 3.0
_MOTOR_NATS = 8.0
_COMPANION_NATS = 1.0
_LOAD = frozenset({"gravity", "inertia", "gravity_load"})
_OF_ITS_MAKE = frozenset(
    {
        "asymmetric_friction",
        "asymmetric_viscous_friction",
        "cogging",
        "commutation_ripple",
        "inductance",
        "power_curve",
        "presliding",
        "sample_hold",
        "torque_saturation",
        "voltage_drop",
    }
)
"""Laws of how a motor and its electronics are made: whoever touches a machine hardly brings them in."""

_WORSE = 1.02  # of the error of windows that only check: what is not worse
Progress = Callable[[str], None]


@final
@dataclass(frozen=True)
class Chosen:
    """The differences that earned their place.

    Attributes:
        joint: with them.
        nats: what each is worth beyond its penalty: of a variable by its index, of an effect by its id.
        lacking: ids of effects that would help on both sides, and are no change.
    """

    joint: JointFit
    nats: dict[int | str, float]
    lacking: tuple[str, ...]


@final
class Chooser:
    """One choice between two sides."""

    def __init__(self, fitter: JointFitter, scale: Scale, limit_nats: float) -> None:
        self._fitter, self._scale, self.limit_nats = fitter, scale, limit_nats
        self._lacking: set[str] = set()
        self._penalty = 0.5 * math.log(max(fitter.worth(), 2.0))

    def chosen(self, joint: JointFit, progress: Progress) -> Chosen:
        """Add to `joint` while something earns its place, then take out what no longer does.

        Where one plant predicts both sides within the tolerance, nothing that matters has changed.
        """
        if max(joint.check_rms) <= self._fitter.tolerance:
            return Chosen(joint, {}, ())
        while joint.model.changes < MOST_CHANGES:
            progress(f"trying what else may have changed; {joint.model.changes} so far")
            better = self._better(joint)
            if better is None:
                break
            joint = better
        return self._exchanged(self._pruned(joint))

    def _exchanged(self, chosen: Chosen) -> Chosen:
        """Put another in the place of each change where that is likelier: the first that helps may be the wrong one."""
        for _ in range(_EXCHANGES):
            joint = chosen.joint
            rivals = [rival for each in chosen.nats for rival in self._rivals(joint, each)]
            better = [(self._worth(joint, rival), bare, rival) for bare, rival in rivals]
            better = [each for each in better if each[0] > _BETTER_NATS]
            better.sort(key=lambda each: -each[0])
            best = next((r for _, b, r in better if not self._is_on_both(b, r, self.net(b, r))), None)
            if best is None:
                break
            chosen = self._pruned(best)
        return chosen

    def _rivals(self, joint: JointFit, each: int | str) -> list[tuple[JointFit, JointFit]]:
        """`joint` without one change, and with others in its place that readings which were not fitted accept."""
        model = self._without(joint.model, each)
        bare = self._fitter.fit(model, model.moved_from(joint.model, joint.x))
        found = []
        for other in promising(
            self._fitter, bare, candidates_for(self._fitter, model, self._scale), self._scale, _RIVALS
        ):
            wider = other.put(model, self._scale)
            if wider.changes <= MOST_CHANGES and (wider.differs, wider.effects) != (
                joint.model.differs,
                joint.model.effects,
            ):
                found.append(self._fitter.fit(wider, wider.moved_from(model, bare.x)))
        return [(bare, rival) for rival in found if sum(rival.check_rms) < _WORSE * sum(joint.check_rms)]

    def net(self, simpler: JointFit, wider: JointFit) -> float:
        """The gain of `wider` beyond the penalty for its further numbers, nats.

        A priori, a changed parameter is likelier than a new law. A changed load is likelier than a changed
        motor: a weaker motor and a heavier load look much alike. A law of how a motor is made is less likely
        than one that somebody brings in.
        """
        size = wider.model.size - simpler.model.size
        laws = len(wider.model.effects) - len(simpler.model.effects)
        made = len(_OF_ITS_MAKE & set(wider.model.effects)) - len(_OF_ITS_MAKE & set(simpler.model.effects))
        motor = wider.model.motor_constants - simpler.model.motor_constants
        prior = _LAW_NATS * laws + _MAKE_NATS * made + _MOTOR_NATS * motor
        return simpler.cost - wider.cost - self._penalty * size - prior

    def _worth(self, simpler: JointFit, wider: JointFit) -> float:
        """What speaks for `wider` in all readings, nats: those that only check need no penalty."""
        return self.net(simpler, wider) + simpler.check_cost - wider.check_cost

    def _better(self, joint: JointFit) -> JointFit | None:
        every = candidates_for(self._fitter, joint.model, self._scale)
        found = []
        for each in promising(self._fitter, joint, every, self._scale, _TRIED):
            wider = each.put(joint.model, self._scale)
            found.append(self._fitter.fit(wider, wider.moved_from(joint.model, joint.x)))
        found = [
            tried for tried in found if self.net(joint, tried) > self.limit_nats and self._lasts(joint, tried)
        ]
        found.sort(key=lambda tried: -self._worth(joint, tried))
        return next(
            (tried for tried in found if not self._is_on_both(joint, tried, self.net(joint, tried))), None
        )

    def _is_on_both(self, joint: JointFit, tried: JointFit, net: float) -> bool:
        """Whether the new effect of `tried` explains more on both sides: then the plant lacks it, and always did."""
        new = set(tried.model.effects) - set(joint.model.effects)
        if not new:
            return False
        effect = next(iter(new))
        plant = tried.model.plant_at(tried.x, after=True)
        own = {slot.symbol: value for slot, value in plant.values.items() if slot.owner == effect}
        model = joint.model.differing(tried.model.differs).lacking(effect, own, self._scale)
        common = self._fitter.fit(model, model.moved_from(tried.model, tried.x))
        spoils = common.check_rms[0] > max(_WORSE * tried.check_rms[0], self._fitter.tolerance)
        if self.net(joint, common) <= net or spoils:
            return False
        self._lacking.add(effect)
        return True

    def _lasts(self, simpler: JointFit, wider: JointFit) -> bool:
        """Whether readings that were not fitted accept it."""
        likelier = wider.check_cost < simpler.check_cost
        return likelier and sum(wider.check_rms) < _WORSE * sum(simpler.check_rms)

    def _pruned(self, joint: JointFit) -> Chosen:
        while True:
            nats: dict[int | str, float] = {}
            weakest: tuple[float, JointFit] | None = None
            moved: list[int | str] = [*joint.model.differs, *joint.model.effects]
            for each in moved:
                model = self._without(joint.model, each)
                simpler = self._fitter.fit(model, model.moved_from(joint.model, joint.x))
                nats[each] = self.net(simpler, joint)
                if nats[each] < self._keeping(joint.model, each) and (
                    weakest is None or nats[each] < weakest[0]
                ):
                    weakest = (nats[each], simpler)
            if weakest is None:
                return Chosen(joint, nats, tuple(sorted(self._lacking)))
            joint = weakest[1]

    def _keeping(self, model: Model, each: int | str) -> float:
        """What a change has to be worth to stay, nats: less where another of one load differs, which comes with it."""
        hung = {model.ways[n].slot.symbol for n in model.differs} | set(model.effects)
        if isinstance(each, str) or model.ways[each].slot.symbol not in _LOAD or len(hung & _LOAD) < 2:
            return self.limit_nats
        return _COMPANION_NATS

    def _without(self, model: Model, each: int | str) -> Model:
        return model.alike(each) if isinstance(each, int) else model.without_effect(each, self._scale)
