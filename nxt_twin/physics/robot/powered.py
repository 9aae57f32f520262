"""The dynamic keys of a robot's plant file: motors, masses, caster."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
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
_MORE: Final = ("scrub_torque_nm", "centre_height_m")
_ALSO: Final = ("kind", "torque_constant_nm_per_a", "inductance_h", "supply_v", "effects")
_SIDES: Final = ("left_motor", "right_motor")
MOTOR_EFFECTS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "asymmetric_friction": ("coulomb_forward_nm", "coulomb_reverse_nm"),
        "quadratic_drag": ("quadratic_drag_nm_s2_per_rad2",),
        "voltage_drop": ("drop_v",),
    }
)
"""Effects of one motor that a robot's model may hold, under `effects` of `left_motor` or `right_motor`."""
_USUAL_SUPPLY_V: Final = 8.0


@final
@dataclass(frozen=True)
class PoweredRobot:
    """What drives a robot.

    Attributes:
        values: in the order of `dynamics.NAMES`, the effects that are said to be in it included.
        caster_back_m: the caster's distance behind the axle.
        height_m: of the centre of mass; 0 where nobody says.
        supply_v: open-circuit battery voltage, where a recording has none.
    """

    values: FloatArray
    caster_back_m: float
    height_m: float
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
    inner = [_motor_effects(drive.dynamics, side) for side in ("left", "right")]
    for motor, (middle_nm, _, _, _) in zip(motors, inner, strict=True):
        motor["coulomb_friction_nm"] = middle_nm or motor["coulomb_friction_nm"]
    mass, yaw, back = (_positive(drive.dynamics.get(name), f"plant, {name}") for name in _BODY)
    effects = drive.effects
    slope = effects.get("floor_slope", {})
    rise = math.sin(math.radians(slope.get("slope_deg", 0.0)))
    uphill = math.radians(slope.get("uphill_heading_deg", 0.0))
    centre = effects.get("centre_of_mass_offset", {})
    pairs = [motor[name] for name in _MOTOR for motor in motors]
    scrub_nm, height_m = (
        _positive(drive.dynamics[name], f"plant, {name}") if drive.dynamics.get(name) else 0.0
        for name in ("scrub_torque_nm", "centre_height_m")
    )
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
        scrub_nm,
        effects.get("battery_sag", {}).get("internal_resistance_ohm", 0.0),
        *(motor[place] for place in (1, 2, 3) for motor in inner),
    ]
    return PoweredRobot(np.array(values), back, height_m, motors[0].get("supply_v", _USUAL_SUPPLY_V))


def dynamics_config(drive: DifferentialDrive, values: FloatArray) -> dict[str, Any]:
    """The dynamic keys with fitted values of the motors, which `powered_robot` reads back."""
    config = {name: value for name, value in drive.dynamics.items() if name in (*_BODY, *_MORE)}
    for place, side in enumerate(_SIDES):
        given = dict(drive.dynamics.get(side) or drive.dynamics.get("motor") or {})
        fitted = {name: _short(values[2 * k + place]) for k, name in enumerate(_MOTOR)}
        given |= fitted
        given["torque_constant_nm_per_a"] = fitted["back_emf_v_s_per_rad"]
        if own := _effects_of(values, place):
            given["effects"] = own
        else:
            given.pop("effects", None)
        config[side] = given
    config["mass_kg"], config["yaw_inertia_kg_m2"] = (_short(values[k]) for k in (10, 11))
    if values[18] > 0.0:
        config["scrub_torque_nm"] = _short(values[18])
    return config


def body_effects(values: FloatArray) -> dict[str, dict[str, float]]:
    """The effects of body, floor and battery that values hold, as `effects` of a plant file; zeros are left out."""
    rise = math.hypot(values[13], values[14])
    found = {
        "caster_drag": {"drag_force_n": values[12]},
        "floor_slope": {
            "slope_deg": math.degrees(math.asin(min(rise, 1.0))),
            "uphill_heading_deg": math.degrees(math.atan2(values[14], values[13])),
        },
        "centre_of_mass_offset": {"offset_left_m": values[15], "offset_forward_m": values[16]},
        "payload_mass": {"added_mass_kg": values[17]},
        "battery_sag": {"internal_resistance_ohm": values[19]},
    }
    return {
        name: {key: _short(value) for key, value in params.items()}
        for name, params in found.items()
        if any(params.values())
    }


def _effects_of(values: FloatArray, place: int) -> dict[str, dict[str, float]]:
    """The effects of one motor (0: left, 1: right) that values hold."""
    middle, uneven, drag, drop = (float(values[k + place]) for k in (4, 20, 22, 24))
    found = {
        "asymmetric_friction": {"coulomb_forward_nm": middle + uneven, "coulomb_reverse_nm": middle - uneven}
        if uneven
        else {},
        "quadratic_drag": {"quadratic_drag_nm_s2_per_rad2": drag} if drag else {},
        "voltage_drop": {"drop_v": drop} if drop else {},
    }
    return {
        name: {key: _short(value) for key, value in params.items()}
        for name, params in found.items()
        if params
    }


def _motor_effects(dynamics: Mapping[str, Any], side: str) -> tuple[float, float, float, float]:
    """Of one motor: Coulomb friction both ways on average (0: as its key says) and half its difference, drag, drop."""
    key = f"{side}_motor" if f"{side}_motor" in dynamics else "motor"
    nested = dynamics[key].get("effects") or {}
    if not isinstance(nested, Mapping):
        raise PlantError("is no mapping of effect ids", where=f"plant, {key}, effects")
    said: dict[str, float] = {}
    for name, params in nested.items():
        where = f"plant, {key}, effects, {name}"
        known = MOTOR_EFFECTS.get(str(name))
        if known is None:
            raise PlantError(
                "is no effect of a robot's motor", where=where, mend=f"known are {', '.join(MOTOR_EFFECTS)}"
            )
        if not isinstance(params, Mapping) or set(params) != set(known):
            raise PlantError(f"needs {', '.join(known)}", where=where)
        said |= {one: _number(params[one], f"{where}, {one}") for one in known}
    forward, reverse = said.get("coulomb_forward_nm", 0.0), said.get("coulomb_reverse_nm", 0.0)
    return (
        0.5 * (forward + reverse),
        0.5 * (forward - reverse),
        said.get("quadratic_drag_nm_s2_per_rad2", 0.0),
        said.get("drop_v", 0.0),
    )


def _short(value: float) -> float:
    return float(f"{value:.8g}")


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


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise PlantError(f"'{value}' is no finite number", where=where)
    return float(value)
