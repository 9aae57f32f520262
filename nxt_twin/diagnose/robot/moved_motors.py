"""The numbers of a robot's motors that a fit moves clearly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from scipy.special import stdtrit

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Moved
from nxt_twin.diagnose.robot.powered_fit import PoweredFit
from nxt_twin.physics.robot.dynamics import NAMES

MOTORS: Final = range(10)
"""Where the motors' numbers stand in `dynamics.NAMES`."""

_KEYS: Final = {
    "back_emf": ("back_emf_v_s_per_rad", "V·s/rad", "back-emf"),
    "resistance": ("resistance_ohm", "Ω", "resistance"),
    "coulomb": ("coulomb_friction_nm", "N·m", "Coulomb friction"),
    "viscous": ("viscous_friction_nm_s_per_rad", "N·m·s/rad", "viscous friction"),
    "rotor": ("inertia_kg_m2", "kg·m²", "inertia"),
}
"""The motors' keys by the names of `dynamics.NAMES`, with unit and words."""

CLEARLY_SIGMAS: Final = 3.0  # standard deviations that a motor's number has to move by to be told as moved
LEAST_MOVED: Final = 0.3
"""A number is told as moved from such a factor (as a logarithm) on; NXT motors differ by 0.15 (seeds 400 to 725)."""


def motor_key(place: int) -> str:
    """A motor's number as the plant's keys name it, such as ``left_motor.resistance_ohm``."""
    side, _, name = NAMES[place].partition("_")
    return f"{side}_motor.{_KEYS[name][0]}"


def moved_motors(given: FloatArray, fitted: PoweredFit) -> dict[str, Moved]:
    """Those that differ from the given ones by more than motors do, and by more than the doubt."""
    reach = float(stdtrit(max(fitted.clusters - 1, 2), 0.975))
    found = {}
    for place in MOTORS:
        off, std = float(fitted.off[place]), float(np.sqrt(fitted.covariance[place, place]))
        if abs(off) > max(LEAST_MOVED, CLEARLY_SIGMAS * std):
            after = float(fitted.values[place])
            low, high = (after * float(np.exp(sign * reach * std)) for sign in (-1.0, 1.0))
            unit = _KEYS[NAMES[place].partition("_")[2]][1]
            found[motor_key(place)] = Moved(
                float(given[place]), after, after * std, unit, interval_95=(low, high)
            )
    return found


def moved_words(moved: Mapping[str, Moved]) -> list[str]:
    """A line for each of them."""
    said = []
    for key, one in moved.items():
        side, _, name = key.partition("_motor.")
        words = next(words for own, _, words in _KEYS.values() if own == name)
        said.append(
            f"The {side} motor's {words} was re-fitted from {one.before:.3g} to {one.after:.3g} {one.unit}."
        )
    return said
