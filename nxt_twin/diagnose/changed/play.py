"""Added inertia, or a load behind play: windows of a second show both alike, closer ones tell them apart."""

from __future__ import annotations

import math
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
_PLAY_NATS = 20.0  # what play has to gain in close windows over more inertia on a fixed load
_OPENS_NATS = 12.0
"""What an open gap has to gain over a second body without play.

On seeds 862, 864, 871, 873 and 874 it gains at most 8 beside the true changes where there is none.
Play of 4 deg gains least, 15 and more in a search: readings are 1 deg apart.
"""

_NARROW_DEG, _NARROW_NATS = 4.0, 30.0
"""What narrower play has to gain over a second body without play.

A fixed load of the family `stiff` gained 17 to 26 by gaps of up to 3.6 deg. True play of those seeds comes out as
4.4 deg and wider, or gains 55 (seed 862).
"""

_LEAST_GAP_DEG = 3.0
"""Narrower play is not told: a load that is fixed looks so, and such a gap gained 25 nats over one that is closed."""

_MAY_LOSE = 0.5
"""Of what close windows gain: what play may lose in the longer ones.

In a second a load strikes now or a moment later, and one such window may speak against play."""

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
        shown = self._shown_nats(fixed, loose)
        if shown <= 0.0:
            return None
        found = self._fitter.fit(loose.model, loose.x)
        lost = found.cost + found.check_cost - heavier.cost - heavier.check_cost
        return found if may_lose(lost, shown) else None

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
        return None if self._shown_nats(fixed, loose) > 0.0 else self._fitter.fit(model, fixed.x)

    def _shown_nats(self, fixed: JointFit, loose: JointFit) -> float:
        """What close windows gain by play, over more inertia and over a second body without play; 0 where none shows.

        A second body lends each window a speed of its own to begin with, and that alone may gain a lot.
        """
        gap, over_fixed = _gap(loose), self._weighing.worth(fixed, loose)
        if shown_nats(gap, over_fixed, math.inf) <= 0.0:
            return 0.0
        return shown_nats(gap, over_fixed, self._weighing.worth(_tied(self._close, loose), loose))

    def _heavier(self, joint: JointFit, n: int) -> JointFit:
        """`joint` with another inertia after: play has to do better than that."""
        model = joint.model.differing([n])
        return self._fitter.fit(model, model.moved_from(joint.model, joint.x))

    def _loose(self, heavier: JointFit, fixed: JointFit, n: int) -> JointFit:
        """What close windows find likeliest behind play, from narrow, middle and wide play."""
        before, after = (_inertia(heavier, n, after=side) for side in (False, True))
        load = after - before if after > before else _LOAD_SHARE * before
        bare = heavier.model.alike(n)
        usual = {each.symbol: each.starts[0] * each.si for each in BACKLASH.parameters}
        starts = [{**usual, "gap": gap * _GAP.si, "load_inertia": load} for gap in _GAP.starts]
        models = [bare.with_effect(BACKLASH.id, start, self._scale) for start in starts]
        fits = [self._close.fit(model, model.moved_from(fixed.model, fixed.x)) for model in models]
        return min(fits, key=lambda each: each.cost)


def shown_nats(gap: float, over_fixed: float, over_tied: float) -> float:
    """What play of `gap`, rad, gains over both loads without play, nats; 0 where that is too little."""
    if gap <= _LEAST_GAP_DEG * _GAP.si or over_fixed <= _PLAY_NATS:
        return 0.0
    asked = _NARROW_NATS if gap < _NARROW_DEG * _GAP.si else _OPENS_NATS
    return min(over_fixed, over_tied) if over_tied > asked else 0.0


def may_lose(lost: float, shown: float) -> bool:
    """Whether play may lose `lost` nats in longer windows, given what it gains in close ones."""
    return lost < _MAY_LOSE * shown


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
