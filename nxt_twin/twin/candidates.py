"""The models that stand beside a motor's own: the handful of effects that are weighed while it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant

NOTHING = "nothing"
UNKNOWN = "unknown"
DEFAULT_CANDIDATES = (
    "coulomb_friction",
    "viscous_friction",
    "constant_load",
    "stiction",
    "payload_inertia",
    "voltage_drop",
    "quadratic_drag",
    "presliding",
    "battery_sag",
)
"""Effects with one number that says how much, which a few seconds can tell apart. The rest is for a diagnosis."""


@final
@dataclass(frozen=True)
class Candidate:
    """A plant with one number in doubt, which is estimated along with the motion.

    Attributes:
        name: the effect's id; `nothing` and `unknown` are the plant as it is.
        plant: with the effect in it.
        slot: of the number in doubt; None for none.
        value: the number to begin with, SI.
        std: its doubt.
        absent: the number at which the plant is as it is without the effect.
        least: it cannot be less.
    """

    name: str
    plant: Plant
    slot: Slot | None = None
    value: float = 0.0
    std: float = 0.0
    absent: float = 0.0
    least: float = 0.0


def candidates(plant: Plant, ids: Sequence[str] = DEFAULT_CANDIDATES) -> tuple[Candidate, ...]:
    """The explanations weighed against a plant: nothing missing, a torque of unknown origin, and effects.

    An effect that the plant has already is weighed as more or less of it. Effects that this installation does not
    know, or whose first number is none, are left out.
    """
    found = (_candidate(plant, effect_id) for effect_id in ids)
    named = tuple(candidate for candidate in found if candidate is not None)
    return (Candidate(NOTHING, plant), Candidate(UNKNOWN, plant), *named)


def _candidate(plant: Plant, effect_id: str) -> Candidate | None:
    if effect_id == "payload_inertia":
        slot = Slot(BASE_OWNER, "inertia")
        value = plant.values[slot]
        return Candidate(effect_id, plant, slot, value, value, value, 0.2 * value)
    known = {effect.id: effect for effect in plant.layout.effects}
    effect = known.get(effect_id)
    if effect is None or effect.fault:
        return None
    slot = Slot(effect_id, effect.parameters[0].symbol)
    parameter = plant.layout.parameters[slot]
    typical = abs(parameter.starts[0]) * parameter.si
    least = parameter.lower * parameter.si
    if effect_id in plant.active:
        value = plant.values[slot]
        return Candidate(effect_id, plant, slot, value, typical, value, least)
    if any(effect_id in other.supersedes for other in plant.effects):
        return None
    numbers = {p.symbol: p.starts[0] * p.si for p in effect.parameters}
    begin = 0.0 if least < 0.0 else 0.5 * typical
    with_effect = plant.with_effect(effect_id, {**numbers, slot.symbol: begin})
    return Candidate(effect_id, with_effect, slot, begin, typical, _absent(plant, effect_id), least)


def _absent(plant: Plant, effect_id: str) -> float:
    """Breakaway torque counts from the dry friction that is there anyway; all else from nothing."""
    coulomb = Slot("coulomb_friction", "coulomb")
    return plant.values.get(coulomb, 0.0) if effect_id == "stiction" else 0.0
