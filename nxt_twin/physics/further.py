"""Motors that turn further by one motion of their inputs: all angles larger, and all that goes with them."""

from __future__ import annotations

from typing import Final

from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import VOLTAGES
from nxt_twin.recording.recording import InputKind

CYCLES: Final = "cycles_per_turn"
"""The parameter's name of what repeats with the angle."""
_CONSTANTS: Final = (Slot(BASE_OWNER, "torque_constant"), Slot(BASE_OWNER, "back_emf"))
"""Torque over current, and voltage over speed: anchors, which have no dimension of their own."""


def turning_further(plant: Plant, times: float, driven: InputKind) -> Plant:
    """The plant whose angles and speeds are that many `times` larger under the commands of `plant`.

    Under a voltage its powers stay, so that its torques fall as its speeds grow. A given torque stays.
    """
    by_volts = plant.layout.frame == "motor" and driven in VOLTAGES
    changed = {}
    for slot, parameter in plant.layout.parameters.items():
        if slot in plant.values:
            power = parameter.dimension.speed - (parameter.name == CYCLES)
            power -= by_volts * (parameter.dimension.torque + (slot in _CONSTANTS))
            changed[slot] = plant.values[slot] * times**power
    return plant.with_values(changed)
