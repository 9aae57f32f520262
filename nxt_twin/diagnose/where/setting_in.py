"""A torque that sets in beyond a speed or an angle, as no effect of the library does."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.where.course import Course
from nxt_twin.diagnose.where.shapes import ShapeFamily, Yardstick
from nxt_twin.physics.effect import Effect, Regime

_SPEEDS = (0.25, 0.45, 0.7, 1.0, 1.3, 1.6)
_PLACES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)


def _above(share: float, course: Course, unit: Yardstick) -> FloatArray:
    """A drag above a share of the usual speed, straight and bent."""
    above = np.maximum(np.abs(course.pace) / unit.speed - share, 0.0)
    return np.array([above, above**2]) * np.sign(course.pace)


def _beyond(share: float, course: Course, unit: Yardstick) -> FloatArray:
    """A pull beyond a share of the reach, constant and growing."""
    low, high = unit.places[0], unit.places[-1]
    past = (course.passed - low) / (high - low) - share
    return np.array([past > 0.0, np.maximum(past, 0.0)], dtype=np.float64)


SETTING_IN: Final[Mapping[Regime, tuple[ShapeFamily, ...]]] = MappingProxyType(
    {
        "high_speed": tuple(ShapeFamily("torque_balance", "torque", partial(_above, s)) for s in _SPEEDS),
        "angle": tuple(ShapeFamily("torque_balance", "torque", partial(_beyond, s)) for s in _PLACES),
    }
)
"""By the regime in which an effect shows."""


def kin_of(effect: Effect) -> tuple[ShapeFamily, ...]:
    """Torques that set in somewhere, of which `effect` is a near relative: it is a torque of one such regime alone.

    Friction that plant files just do not state has none.
    """
    if effect.plain or effect.equation_of != "torque_balance" or len(effect.shows) != 1:
        return ()
    return SETTING_IN.get(effect.shows[0], ())
