"""Found effects whose parameters show that they stand for one law that none of them is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from typing import Final

from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

SAME_CYCLES: Final = 0.02
"""Share by which the cycles a turn of two effects may differ to count as the same."""

SAME_PHASE_RAD: Final = 0.15
"""Distance of two phases, or of one from the other's opposite, that chance gives once in ten pairs of equal cycles.

On seed 701 a pawl was named cogging with friction by angle, 0.03 rad apart.
"""

NO_CURVE: Final = 1.3
"""Multiple of its least value below which Stribeck's speed tells of no curve: friction is larger at rest alone.

So three motors whose friction grows at rest came out (seeds 700 and 721): 1.0 to 1.2. True stiction was at 20 and more.
"""

_AT_BOUND = 1e-6  # of the bound


def is_stretched(problem: Problem, plant: Plant, found: Sequence[Effect]) -> bool:
    """Whether a size or a shape of a found effect rests on its upper bound, so that the readings ask for another law.

    A phase comes round, and its bound means nothing. Nor does that of what shapes a lag that wanders by no law, or of a
    number that is only tried. Nor does the usual law, such as the exponent 2 of Stribeck's curve: whoever draws
    that curve draws it so. The speed of that curve is asked for at its lower bound.
    """
    for effect in found:
        for parameter in effect.parameters:
            scaled = plant.layout.parameters[Slot(effect.id, parameter.symbol)].scaled(problem.scale)
            value = plant.values[Slot(effect.id, parameter.symbol)] / scaled.si
            free = not scaled.is_bounded or parameter.name.endswith("phase_deg")
            means_nothing = free or scaled.otherwise == scaled.upper
            if parameter.name.startswith("stribeck_speed") and value < NO_CURVE * scaled.lower:
                return True
            if not means_nothing and value >= (1.0 - _AT_BOUND) * scaled.upper > 0.0:
                return True
    return False


def is_one_sided(plant: Plant, found: Sequence[Effect]) -> bool:
    """Whether a torque and a friction go with the angle alike: together they are one law that acts one way only.

    A pawl holds a motor at some angles and one way only. It is half such a torque and half such a friction, of the same
    cycles, in phase or opposite.
    """
    turning = [_cycles_and_phase(plant, effect) for effect in found if effect.equation_of == "torque_balance"]
    pairs = combinations([one for one in turning if one is not None], 2)
    return any(_are_alike(one, other) for one, other in pairs)


def _cycles_and_phase(plant: Plant, effect: Effect) -> tuple[float, float] | None:
    slots = Slot(effect.id, "cycles"), Slot(effect.id, "phase")
    if not all(slot in plant.values for slot in slots):
        return None
    return plant.values[slots[0]], plant.values[slots[1]]


def _are_alike(one: tuple[float, float], other: tuple[float, float]) -> bool:
    cycles_off = abs(one[0] / other[0] - 1.0)
    apart = (one[1] - other[1]) % math.pi
    return cycles_off < SAME_CYCLES and min(apart, math.pi - apart) < SAME_PHASE_RAD
