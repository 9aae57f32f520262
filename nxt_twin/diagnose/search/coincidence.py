"""What speaks against an effect whose size happens to hide what would set it apart."""

from __future__ import annotations

from typing import Final

from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

HIDDEN_BY: Final = {"constant_load": Slot("coulomb_friction", "coulomb")}
"""By effect: what a size has to exceed so that a motor at rest shows it."""
_TWINS: Final = {"constant_load": "asymmetric_friction"}
"""By effect: the one that moves a motor just as it does where its size is hidden."""


def coincidence_nats(plant: Plant, effect: Effect) -> float:
    """What speaks against `effect` at the size that it has in `plant`, nats.

    A steady load may have any size. Below friction it moves a motor as friction by direction does, which is always so.
    Of two laws that do alike, the one that could have done otherwise is the less likely.
    """
    hiding = HIDDEN_BY.get(effect.id)
    if hiding is None or hiding not in plant.values:
        return 0.0
    size = abs(plant.values[Slot(effect.id, effect.parameters[0].symbol)])
    return LIMITS.coincidence_nats if size < plant.values[hiding] else 0.0


def are_twins(plant: Plant, effect: Effect, other: Effect) -> bool:
    """Whether `other` moves a motor just as `effect` does at the size that it has in `plant`.

    What tells the two apart is then how a simulation lets a motor stick, and no property of a motor.
    """
    return _TWINS.get(effect.id) == other.id and coincidence_nats(plant, effect) > 0.0
