"""Added inertia, or a load behind play: windows of a second show both alike, closer ones tell them apart."""

from __future__ import annotations

from dataclasses import replace
from typing import final

from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.changed.model import Model
from nxt_twin.diagnose.changed.weighing import Weighing
from nxt_twin.diagnose.search.trials import addable_effects as lacking
from nxt_twin.physics.effects.transmission import BACKLASH
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import Scale

CLOSE_WINDOW_S = 0.3
"""A load crosses its play in some hundredths of a second: later in a window both loads move alike."""

_GAP = BACKLASH.parameters[0]
_GAP_SLOT = Slot(BACKLASH.id, _GAP.symbol)
_PLAY_NATS = 20.0
_OPENS_NATS = 30.0
"""What an open gap has to gain over a second body without play.

On seeds 862 and 864 it gains 48 and more where there is play, and up to 25 where there is none.
"""

_NO_LESS_LIKELY_NATS = 2.0
_TIED_DEG = 0.1  # narrower than any play: a second body that is as good as fixed
_LOAD_SHARE = 0.5  # of the inertia: a load behind play where the fit shows no more inertia


@final
class PlayTest:
    """Whether what seems to be another inertia is a load behind play.

    Args:
        fitter: of the windows in which all else is decided.
        close: of windows of `CLOSE_WINDOW_S`, whose readings count as exactly as they were read.
        weighing: how fits are weighed.
        scale: of the plant.
    """

    def __init__(self, fitter: JointFitter, close: JointFitter, weighing: Weighing, scale: Scale) -> None:
        self._fitter, self._close = fitter, close
        self._weighing, self._scale = weighing, scale
        self._signals = fitter.sides[1].jobs[0].signals

    def passed(self, joint: JointFit) -> JointFit | None:
        """`joint` with a load behind play after, in the place of another inertia; None where no play shows.

        Close windows have to show it, and the longer ones must not speak against it.
        """
        n = _inertia_way(joint.model)
        can_have = {effect.id for effect in lacking(joint.model.after, self._signals)}
        if n is None or BACKLASH.id not in can_have:
            return None
        heavier = joint if n in joint.model.differs else self._heavier(joint, n)
        fixed = self._close.fit(heavier.model, heavier.x)
        loose = self._loose(heavier, fixed, n)
        if not self._shows(fixed, loose):
            return None
        found = self._fitter.fit(loose.model, loose.x)
        gain = heavier.cost + heavier.check_cost - found.cost - found.check_cost
        return found if gain > -_NO_LESS_LIKELY_NATS else None

    def without(self, joint: JointFit) -> JointFit | None:
        """`joint` with another inertia in the place of its play, where close windows do not insist on the play.

        Play may have come in while another change was still missing.
        """
        n = _inertia_way(joint.model)
        if n is None or BACKLASH.id not in joint.model.effects:
            return None
        model = joint.model.without_effect(BACKLASH.id, self._scale).differing([n])
        fixed = self._close.fit(model, model.moved_from(joint.model, joint.x))
        loose = self._close.fit(joint.model, joint.x)
        return None if self._shows(fixed, loose) else self._fitter.fit(model, fixed.x)

    def _shows(self, fixed: JointFit, loose: JointFit) -> bool:
        """Whether close windows show play: rather than more inertia, and rather than a second body without play.

        A second body lends each window a speed of its own to begin with, and that alone may gain a lot.
        """
        if _gap(loose) <= min(_GAP.starts) * _GAP.si or self._weighing.worth(fixed, loose) <= _PLAY_NATS:
            return False
        return self._weighing.worth(_tied(self._close, loose), loose) > _OPENS_NATS

    def _heavier(self, joint: JointFit, n: int) -> JointFit:
        """`joint` with another inertia after: play has to do better than that."""
        model = joint.model.differing([n])
        return self._fitter.fit(model, model.moved_from(joint.model, joint.x))

    def _loose(self, heavier: JointFit, fixed: JointFit, n: int) -> JointFit:
        """What close windows find likeliest behind play, from narrow, middle and wide play."""
        before, after = (_inertia(heavier, n, after=side) for side in (False, True))
        load = after - before if after > before else _LOAD_SHARE * before
        bare = heavier.model.alike(n)
        starts = [{"gap": start * _GAP.si, "load_inertia": load} for start in _GAP.starts]
        models = [bare.with_effect(BACKLASH.id, start, self._scale) for start in starts]
        fits = [self._close.fit(model, model.moved_from(fixed.model, fixed.x)) for model in models]
        return min(fits, key=lambda each: each.cost)


def _gap(loose: JointFit) -> float:
    return loose.model.plant_at(loose.x, after=True).values[_GAP_SLOT]


def _tied(fitter: JointFitter, loose: JointFit) -> JointFit:
    """`loose` with its load on a shaft without play."""
    model = loose.model
    after = model.after.with_values({_GAP_SLOT: _TIED_DEG * _GAP.si})
    added = tuple(variable for variable in model.added if variable.slots[0] != _GAP_SLOT)
    model = replace(model, after=after, added=added)
    return fitter.fit(model, model.moved_from(loose.model, loose.x))


def _inertia_way(model: Model) -> int | None:
    """The index of the inertia among the ways in which sides may differ."""
    return next((n for n, way in enumerate(model.ways) if way.slot.symbol == "inertia"), None)


def _inertia(joint: JointFit, n: int, *, after: bool) -> float:
    return joint.model.plant_at(joint.x, after=after).values[joint.model.ways[n].slot]
