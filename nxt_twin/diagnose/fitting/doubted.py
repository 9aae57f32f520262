"""Which readings a plant takes for faults."""

from __future__ import annotations

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

_EVEN = 0.5  # of the belief that readings have beforehand, below which one is doubted


def is_doubted(plant: Plant, weight: FloatArray) -> BoolArray:
    """Whether a fault in `plant` explains a reading that the motor's motion does not.

    Motion and fault explain a motor at rest alike. Such a reading keeps the belief that readings have beforehand, which
    is small where many are stale. So belief counts as a share of that one.

    Args:
        plant: with or without a fault that doubts readings.
        weight: belief in each reading, of any shape.
    """
    faults = [Slot(e.id, e.parameters[0].symbol) for e in plant.effects if "outlier" in e.terms]
    believed = 1.0 - sum(plant.values[slot] for slot in faults)
    return weight < _EVEN * max(believed, 0.0)
