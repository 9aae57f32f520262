"""What speaks for a change: what it gains, less what is likely to gain as much where nothing changed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.changed.joint import JointFit
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.search.notable import is_notable
from nxt_twin.physics.parameter import Scale

LOAD = frozenset({"gravity", "inertia", "gravity_load"})
_LAW_NATS = 6.0  # asked of each new effect beyond its penalty
_MAKE_NATS = 12.0  # asked beyond that of an effect of how a motor is made
_BODY_NATS = 12.0  # asked beyond `_LAW_NATS` of a second body on the shaft
_MOTOR_NATS = _LAW_NATS + _MAKE_NATS  # a motor's constants are how it is made
_COMPANION_NATS = 1.0  # asked of a parameter of the load beside another of that load: one load brings both
CLOSE_NATS = 20.0
"""What a change has to gain in close windows, where it is slight, or brings no window nearer.

What a model lacks looks like such a change."""

WORSE = 1.02
"""Of the error of windows that only check: what is not worse."""

_NEARER = 0.95  # of the error of windows that only check
_FAR_NEARER = 0.5
"""Of that error: what lasts though its windows are called less likely.

A fit weighs windows by the error that it has where it is fitted. Where that is small, one window in which the motor
sticks by chance counts too much: a stiction was lost so. Seeds 870 to 873 keep their answers."""
_SLIGHT = 0.25  # of the parameter, by factor
_DRIFTS = 0.05
"""What friction may differ by from run to run with nothing done, by factor: no reading speaks loudly enough for less.

On seeds 861, 865, 870 and 872 it seems to differ by 2 to 4 % in 4 of 400 unchanged pairs, and gains up to 57 nats."""

FRICTION = frozenset({"coulomb", "viscous"})
_SLIGHT_NATS = 15.0  # asked beyond the limit of a slight change beside another, which it needs to stay
_SECOND_BODIES = frozenset({"backlash", "shaft_compliance"})
"""A load on a stiff shaft, or behind little play, moves as one that is fixed: more inertia says it with less."""

_OF_ITS_MAKE = frozenset(
    {
        "asymmetric_friction",
        "asymmetric_viscous_friction",
        "clock_skew",
        "cogging",
        "commutation_ripple",
        "current_limit",
        "encoder_eccentricity",
        "friction_warmup",
        "inductance",
        "missed_counts",
        "power_curve",
        "presliding",
        "sample_hold",
        "shaft_compliance",
        "stale_samples",
        "torque_saturation",
        "voltage_drop",
        "winding_heating",
    }
)
"""Laws of how a motor, its encoder and its electronics are made: whoever touches a machine hardly brings them in."""


@final
@dataclass(frozen=True)
class Weighing:
    """How fits are weighed against one another.

    Attributes:
        penalty: of one number, nats.
        limit_nats: what a change has to gain beyond all penalties.
        inexact_nats: what more a law or a motor's constant has to gain, since the model is inexact on the side before.
        scale: of the plant.
        within: whether one plant predicts both sides within the tolerance: what is slight does not matter then.
    """

    penalty: float
    limit_nats: float
    inexact_nats: float
    scale: Scale
    within: bool = False

    def net(self, simpler: JointFit, wider: JointFit) -> float:
        """The gain of `wider` beyond all penalties, nats."""
        motor = wider.model.motor_constants - simpler.model.motor_constants
        doubtful = _more(simpler, wider) + motor
        return self.plain(simpler, wider) - self.inexact_nats * doubtful

    def plain(self, simpler: JointFit, wider: JointFit) -> float:
        """The gain of `wider` as if the model were exact, nats.

        A priori, a changed parameter is likelier than a new law. A changed load is likelier than a changed
        motor: a weaker motor and a heavier load look much alike. A law of how a motor is made is less likely
        than one that somebody brings in.
        """
        size = wider.model.size - simpler.model.size
        motor = wider.model.motor_constants - simpler.model.motor_constants
        laws = _LAW_NATS * _more(simpler, wider) + _MAKE_NATS * _more(simpler, wider, _OF_ITS_MAKE)
        prior = laws + _BODY_NATS * _more(simpler, wider, _SECOND_BODIES) + _MOTOR_NATS * motor
        return simpler.cost - wider.cost - self.penalty * size - prior

    def worth(self, simpler: JointFit, wider: JointFit) -> float:
        """What speaks for `wider` in all readings, nats: those that only check need no penalty.

        Each change more has to gain what a change has to gain.
        """
        more = _told(wider.model) - _told(simpler.model)
        return self._gain(simpler, wider) - self.limit_nats * more

    def _gain(self, simpler: JointFit, wider: JointFit) -> float:
        """In all readings, nats."""
        return self.net(simpler, wider) + simpler.check_cost - wider.check_cost

    def lasts(self, simpler: JointFit, wider: JointFit) -> bool:
        """Whether windows that were not fitted accept `wider`: they are likelier and not worse, or far nearer."""
        before, now = sum(simpler.check_rms), sum(wider.check_rms)
        likelier = wider.check_cost < simpler.check_cost
        return (likelier and now < WORSE * before) or now < _FAR_NEARER * before

    def matters(self, simpler: JointFit, wider: JointFit) -> bool:
        """Whether what differs brings windows nearer that no fit saw, or the readings speak loudly for it."""
        nearer = sum(wider.check_rms) < _NEARER * sum(simpler.check_rms)
        return nearer or self._gain(simpler, wider) > CLOSE_NATS

    def is_loud(self, simpler: JointFit, wider: JointFit) -> bool:
        """Whether `wider` gains what one of many numbers hardly gains by chance."""
        return self.net(simpler, wider) > self.limit_nats + CLOSE_NATS

    def keeping(self, joint: JointFit, each: int | str) -> float:
        """The worth that a change needs to stay, nats: less where another of one load differs, which comes with it.

        More where it is slight, the more so beside another: what a model lacks of a large change looks like that.
        An effect too small to have a name is no change: over what a machine does it makes no difference.
        """
        model = joint.model
        if isinstance(each, str):
            return self.limit_nats if self.has_a_name(joint, each) else math.inf
        if self.is_companion(joint, each):
            return _COMPANION_NATS
        if is_drift(joint, each):
            return math.inf
        return self.limit_nats if _moved(joint, each) >= _SLIGHT else self._keeping_slight(model)

    def is_companion(self, joint: JointFit, each: int | str) -> bool:
        """Whether a parameter of the load differs beside another part of that load, which brings it."""
        model = joint.model
        hung = {model.ways[n].slot.symbol for n in model.differs} | set(model.effects)
        return isinstance(each, int) and model.ways[each].slot.symbol in LOAD and len(hung & LOAD) > 1

    def _keeping_slight(self, model: Model) -> float:
        if self.within:
            return math.inf
        return self.limit_nats + _SLIGHT_NATS if model.changes > 1 else max(self.limit_nats, CLOSE_NATS)

    def has_a_name(self, joint: JointFit, each: int | str) -> bool:
        """Whether a change is large enough to be named: an effect has a notable size, a parameter always is."""
        if not isinstance(each, str):
            return True
        plant = joint.model.plant_at(joint.x, after=True)
        return is_notable(plant, joint.model.plant.layout.effect(each), self.scale)


def is_drift(joint: JointFit, n: int) -> bool:
    """Whether the n-th way to differ is friction, and differs by no more than it may from run to run."""
    return joint.model.ways[n].slot.symbol in FRICTION and _moved(joint, n) < _DRIFTS


def _moved(joint: JointFit, n: int) -> float:
    """By how much the n-th way differs, in its ordinary size."""
    model = joint.model
    return abs(float(joint.x[len(model.shared) + model.differs.index(n)])) / model.ways[n].size


def _told(model: Model) -> int:
    """How many changes an answer tells; inertia and gravity of one load count as one."""
    hung = {model.ways[n].slot.symbol for n in model.differs} | set(model.effects)
    return model.changes - max(len(hung & LOAD) - 1, 0)


def _more(simpler: JointFit, wider: JointFit, of: frozenset[str] | None = None) -> int:
    """How many more effects of these act after in `wider`."""
    counts = [
        len([each for each in one.model.effects if of is None or each in of]) for one in (simpler, wider)
    ]
    return counts[1] - counts[0]
