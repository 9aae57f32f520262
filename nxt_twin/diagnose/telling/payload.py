"""An arm beside a risen inertia may be one thing: a payload that hangs on the axis since before the recordings."""

from __future__ import annotations

from nxt_twin.diagnose.diagnosis import Confusion
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.search.notable import LEAST_LEVER_M
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot

_ARM, _PAYLOAD = "gravity_load", "hanging_payload"
_G = 9.81  # m/s²
_LEAST_RISE = 0.1  # of the given inertia; less is how far off given numbers commonly are
_LONGEST_LEVER_M = 1.0  # longer than a motor carries a payload on
_INERTIA = Slot(BASE_OWNER, "inertia")


def as_a_payload(evidence: Evidence, effect: Effect) -> tuple[Confusion, ...]:
    """The payload that an arm and a risen inertia would make together, if its lever is one that a motor carries.

    A payload m on a lever l brings τg = m·g·l and J = m·l², so that l = J·g/τg.
    """
    if effect.id != _ARM:
        return ()
    given, refit = (
        plant.values.get(_INERTIA, 0.0) for plant in (evidence.problem.plant, evidence.final.plant)
    )
    added = refit - given
    gravity = abs(evidence.final.plant.values[Slot(_ARM, "gravity")])
    lever_m = added * _G / gravity if gravity > 0.0 else 0.0
    if added < _LEAST_RISE * given or not LEAST_LEVER_M < lever_m < _LONGEST_LEVER_M:
        return ()
    why = (
        f"the inertia rose by {100.0 * added / given:.0f} % as well: "
        f"a payload on a lever of {100.0 * lever_m:.0f} cm brings both"
    )
    return (Confusion(_PAYLOAD, why),)
