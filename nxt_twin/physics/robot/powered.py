"""The dynamic keys of a robot's plant file: motors, masses, caster."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import PlantError
from nxt_twin.physics.robot.drive import DifferentialDrive

_MOTOR: Final = (
    "back_emf_v_s_per_rad",
    "resistance_ohm",
    "coulomb_friction_nm",
    "viscous_friction_nm_s_per_rad",
    "inertia_kg_m2",
)
_BODY: Final = ("mass_kg", "yaw_inertia_kg_m2", "caster_back_m")
_ALSO: Final = ("kind", "torque_constant_nm_per_a", "inductance_h", "supply_v")
_USUAL_SUPPLY_V: Final = 8.0


@final
@dataclass(frozen=True)
class PoweredRobot:
    """What drives a robot.

    Attributes:
        values: in the order of `dynamics.NAMES`, the effects that are said to be in it included.
        caster_back_m: the caster's distance behind the axle.
        supply_v: open-circuit battery voltage, where a recording has none.
    """

    values: FloatArray
    caster_back_m: float
    supply_v: float


def is_powered(drive: DifferentialDrive) -> bool:
    """Whether a robot's file says how its wheels are driven."""
    return bool(drive.dynamics)


def powered_robot(drive: DifferentialDrive) -> PoweredRobot:
    """Read the dynamic keys.

    Raises:
        PlantError: a key is missing, or a value is none.
    """
    motors = [_motor(drive.dynamics, side) for side in ("left", "right")]
    mass, yaw, back = (_positive(drive.dynamics.get(name), f"plant, {name}") for name in _BODY)
    effects = drive.effects
    slope = effects.get("floor_slope", {})
    rise = math.sin(math.radians(slope.get("slope_deg", 0.0)))
    uphill = math.radians(slope.get("uphill_heading_deg", 0.0))
    centre = effects.get("centre_of_mass_offset", {})
    pairs = [motor[name] for name in _MOTOR for motor in motors]
    values = [
        *pairs,
        mass,
        yaw,
        effects.get("caster_drag", {}).get("drag_force_n", 0.0),
        rise * math.cos(uphill),
        rise * math.sin(uphill),
        centre.get("offset_left_m", 0.0),
        centre.get("offset_forward_m", 0.0),
        effects.get("payload_mass", {}).get("added_mass_kg", 0.0),
    ]
    return PoweredRobot(np.array(values), back, motors[0].get("supply_v", _USUAL_SUPPLY_V))


def dynamics_config(drive: DifferentialDrive, values: FloatArray) -> dict[str, Any]:
    """The dynamic keys with fitted values of the motors, which `powered_robot` reads back."""
    config = {name: value for name, value in drive.dynamics.items() if name in _BODY}
    for side, place in (("left_motor", 0), ("right_motor", 1)):
        given = dict(drive.dynamics.get(side) or drive.dynamics.get("motor") or {})
        fitted = {name: float(f"{values[2 * k + place]:.8g}") for k, name in enumerate(_MOTOR)}
        given |= fitted
        given["torque_constant_nm_per_a"] = fitted["back_emf_v_s_per_rad"]
        config[side] = given
    config["mass_kg"], config["yaw_inertia_kg_m2"] = (float(f"{values[k]:.8g}") for k in (10, 11))
    return config


def _motor(dynamics: Mapping[str, Any], side: str) -> dict[str, float]:
    key = f"{side}_motor" if f"{side}_motor" in dynamics else "motor"
    given = dynamics.get(key)
    if not isinstance(given, Mapping):
        raise PlantError("is missing", where=f"plant, {key}", mend="give a dc_motor's keys")
    unknown = sorted(set(map(str, given)) - {*_MOTOR, *_ALSO})
    if unknown:
        raise PlantError(
            f"unknown key '{unknown[0]}'", where=f"plant, {key}", mend=f"known are {', '.join(_MOTOR)}"
        )
    found = {name: _positive(given.get(name), f"plant, {key}, {name}") for name in _MOTOR}
    if "supply_v" in given:
        found["supply_v"] = _positive(given["supply_v"], f"plant, {key}, supply_v")
    return found


def _positive(value: object, where: str) -> float:
    if value is None:
        raise PlantError("is missing", where=where, mend="add it")
    if (
        isinstance(value, bool)
        or not isinstance(value, int | float)
        or not math.isfinite(value)
        or value <= 0.0
    ):
        raise PlantError(f"'{value}' is no positive number", where=where)
    return float(value)
