"""An arm beside a risen inertia may be one thing: a payload that hangs on the axis since before the recordings."""

from __future__ import annotations

from dataclasses import replace

from nxt_twin.diagnose.diagnosis import Confusion, Estimate, FoundEffect, Moved
from nxt_twin.diagnose.judging.evidence import Evidence
from nxt_twin.diagnose.search.notable import LEAST_LEVER_M, LONGEST_LEVER_M
from nxt_twin.diagnose.telling.estimates import refitted
from nxt_twin.physics.layout import Slot

_ARM, _PAYLOAD = "gravity_load", "hanging_payload"
_G = 9.81  # m/s²
_LEAST_RISE = 0.1  # of the given inertia; less is how far off given numbers commonly are
_SURE_RISE = 0.4
"""Of the given inertia. Where the given numbers are about a fifth off, 29 arms rose by 0.35 at most.

Eight of 25 payloads that hung from the first reading on rose by 0.45 to 1.04."""
_SURELY = 2.0
"""Standard deviations by which a rise is clear of `_LEAST_RISE`, and half the width of its interval."""


def is_a_payload_s(evidence: Evidence) -> bool:
    """Whether the inertia rose beside a found arm on a lever that a motor carries, so that the rise is a payload's."""
    inertia = refitted(evidence).get("inertia_kg_m2")
    arms = [effect for effect, _ in evidence.explanation.found if effect.id == _ARM]
    values = evidence.final.plant.values
    weighs = [abs(values[Slot(arm.id, arm.parameters[0].symbol)]) for arm in arms]
    return inertia is not None and any(_lever_m(inertia, gravity) is not None for gravity in weighs)


def _lever_m(inertia: Moved, gravity_nm: float) -> float | None:
    """The lever of a payload that brings this torque and the rise of `inertia`; None where no motor carries it so."""
    added = inertia.after - inertia.before
    if added < _LEAST_RISE * inertia.before or gravity_nm <= 0.0:
        return None
    lever_m = added * _G / gravity_nm
    return lever_m if LEAST_LEVER_M < lever_m < LONGEST_LEVER_M else None


def as_a_payload(evidence: Evidence, found: FoundEffect) -> FoundEffect:
    """`found` as it is told: an arm that may be a payload lists it, one that surely is has its name.

    A payload m on a lever l brings τg = m·g·l and J = m·l², so that l = J·g/τg. A motor has to be able to carry that.
    The plant holds it as an arm and a larger inertia, which move it alike.
    """
    inertia = refitted(evidence).get("inertia_kg_m2") if found.id == _ARM else None
    if inertia is None:
        return found
    given, added = inertia.before, inertia.after - inertia.before
    gravity = abs(found.params["gravity_torque_nm"].value)
    lever_m = _lever_m(inertia, gravity)
    if lever_m is None:
        return found
    rise = f"the inertia rose by {100.0 * added / given:.0f} %"
    brings = f"a payload on a lever of {100.0 * lever_m:.0f} cm brings"
    behind = any(
        effect.moving for effect in evidence.final.plant.effects
    )  # readings hardly part two inertias
    # An inertia that was fitted without the arm says nothing of a rise.
    open_rise = behind or evidence.record.given_is_a_fit
    if open_rise or added < _SURE_RISE * given or added - _SURELY * inertia.std < _LEAST_RISE * given:
        others = [one for one in found.confusable_with if one.id != _PAYLOAD]
        return replace(
            found, confusable_with=(*others, Confusion(_PAYLOAD, f"{rise} as well: {brings} both"))
        )
    arm = Confusion(_ARM, f"{rise}, as {brings}; an arm that weighs nothing, on a heavier motor, moves alike")
    others = [one for one in found.confusable_with if one.id != _PAYLOAD]
    payload = evidence.final.plant.layout.effect(_PAYLOAD)
    params = {
        "gravity_torque_nm": found.params["gravity_torque_nm"],
        "added_inertia_kg_m2": Estimate(
            added,
            inertia.std,
            inertia.unit,
            (added - _SURELY * inertia.std, added + _SURELY * inertia.std),
            inertia.rests_on,
        ),
        "phase_deg": found.params["phase_deg"],
    }
    return replace(
        found,
        id=payload.id,
        name=payload.name,
        equation=payload.equation,
        params=params,
        confusable_with=(arm, *others),
    )
