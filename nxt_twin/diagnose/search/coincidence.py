"""What speaks against an effect whose size happens to hide what would set it apart."""

from __future__ import annotations

from typing import Final

from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

_LOAD, _FRICTION = "constant_load", "asymmetric_friction"
HIDDEN_BY: Final = {_LOAD: Slot("coulomb_friction", "coulomb")}
"""By effect: what a size has to exceed so that a motor at rest shows it."""
_TWINS: Final = {_LOAD: _FRICTION}
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


def as_twin(plant: Plant, effect: Effect, other: Effect) -> Plant | None:
    """`plant` with `other` in the place of `effect`, of a size at which both move a motor alike; None where none is.

    A load adds to friction one way and takes from it the other way.
    """
    if (effect.id, other.id) == (_LOAD, _FRICTION) and HIDDEN_BY[_LOAD] in plant.values:
        load, friction = plant.values[Slot(_LOAD, "load")], plant.values[HIDDEN_BY[_LOAD]]
        if abs(load) >= friction:
            return None
        ways = {"forward": friction - load, "reverse": friction + load}
        return plant.without([_LOAD]).with_effect(_FRICTION, ways)
    if (effect.id, other.id) == (_FRICTION, _LOAD):
        forward, reverse = (plant.values[Slot(_FRICTION, way)] for way in ("forward", "reverse"))
        hiding = HIDDEN_BY[_LOAD]
        plain = plant.without([_FRICTION]).with_effect(
            hiding.owner, {hiding.symbol: 0.5 * (forward + reverse)}
        )
        return plain.with_effect(_LOAD, {"load": 0.5 * (reverse - forward)})
    return None
