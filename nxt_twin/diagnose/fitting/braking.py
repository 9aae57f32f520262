"""Motors that driven motion hardly tells apart: their own voltage brakes one as friction brakes the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fit import Variable
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant

_CONSTANT: Final = Slot(BASE_OWNER, "torque_constant")
_INERTIA: Final = Slot(BASE_OWNER, "inertia")
_RESISTANCE: Final = Slot(BASE_OWNER, "resistance")
_VISCOUS: Final = Slot("viscous_friction", "viscous")


def braked_alike(plant: Plant, variables: Sequence[Variable]) -> FloatArray:
    """How the variables, SI, change to a motor of a larger torque constant that driven motion hardly tells.

    It has as much more inertia and torque of every kind, and viscous friction is less by what its voltage brakes more:
    K/(R·J) and K²/(R·J) + B/J stay. Zeros where one of these is no variable; shape (variables,).
    """
    slots = [variable.slots[0] for variable in variables]
    if not {_CONSTANT, _INERTIA, _VISCOUS} <= {*slots} or _RESISTANCE not in plant.values:
        return np.zeros(len(slots))
    of, values = plant.layout.parameters, plant.values
    more = {slot: values[slot] for slot in slots if of[slot].likeness > 0.0 and not of[slot].is_electrical}
    constant = values[_CONSTANT]
    more[_CONSTANT] = constant
    more[_VISCOUS] -= constant**2 / values[_RESISTANCE]
    return np.array([more.get(slot, 0.0) for slot in slots])


def measured_along(slopes: FloatArray, along: FloatArray, rise: FloatArray) -> FloatArray:
    """`slopes` that rise by `rise` along a direction, as was measured there, shape (variables, readings).

    What single variables do may cancel along it. Errors of their finite differences, from stops and sticking, do not.
    """
    size = float(along @ along)
    return np.asarray(slopes + np.outer(along, rise - along @ slopes) / size) if size > 0.0 else slopes
