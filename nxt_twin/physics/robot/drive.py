"""A differential drive as its plant file tells it."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final, cast, final

from nxt_twin.errors import PlantError
from nxt_twin.recording.case import ROBOT_KIND
from nxt_twin.recording.columns import PORTS, Port

GEOMETRY_EFFECTS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "wheel_radius": ("mean_wheel_radius_m",),
        "unequal_wheels": ("wheel_radius_ratio",),
        "wrong_track": ("track_m",),
        "pose_offset": ("offset_forward_m", "offset_left_m", "heading_offset_deg"),
    }
)
"""The parameters that each effect of the geometry carries, by names."""

OTHER_EFFECTS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "clock_skew": ("lag_s", "lag_span_s", "rate_error"),
        "wheel_slip": ("slip_ratio",),
    }
)
"""Effects that differ from recording to recording: a plant file keeps them as a remark."""

DYNAMIC_KEYS: Final = (
    "motor",
    "left_motor",
    "right_motor",
    "mass_kg",
    "yaw_inertia_kg_m2",
    "caster_back_m",
    "scrub_torque_nm",
    "centre_height_m",
)
DYNAMIC_EFFECTS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "caster_drag": ("drag_force_n",),
        "floor_slope": ("slope_deg", "uphill_heading_deg"),
        "payload_mass": ("added_mass_kg",),
        "centre_of_mass_offset": ("offset_left_m", "offset_forward_m"),
        "battery_sag": ("internal_resistance_ohm",),
    }
)
"""Effects of body, floor and battery, which need the motors' powers to be seen."""

_OPTIONAL: Final = ("heading_offset_deg", "offset_forward_m", "offset_left_m")
_BASE: Final = ("left_wheel_radius_m", "right_wheel_radius_m", "track_m")


@final
@dataclass(frozen=True)
class Geometry:
    """Wheels, and where on the robot its pose is measured.

    Attributes:
        mean_wheel_radius_m: of both wheels.
        wheel_radius_ratio: right over left.
        track_m: effective distance of the wheels.
        offset_forward_m: of the measured point from the axle's middle.
        offset_left_m: likewise, to the left.
        heading_offset_deg: measured heading minus the robot's.
    """

    mean_wheel_radius_m: float
    wheel_radius_ratio: float
    track_m: float
    offset_forward_m: float = 0.0
    offset_left_m: float = 0.0
    heading_offset_deg: float = 0.0

    @property
    def left_wheel_radius_m(self) -> float:
        """The left wheel's radius, m."""
        return 2.0 * self.mean_wheel_radius_m / (1.0 + self.wheel_radius_ratio)

    @property
    def right_wheel_radius_m(self) -> float:
        """The right wheel's radius, m."""
        return self.left_wheel_radius_m * self.wheel_radius_ratio


@final
@dataclass(frozen=True)
class DifferentialDrive:
    """A robot on two wheels.

    Attributes:
        left: the port of the left wheel's motor.
        right: the port of the right wheel's.
        geometry: its wheels, and where its pose is measured.
        dynamics: the keys that say how it is driven, unread; empty where only wheels and pose are modelled.
        effects: ids of effects that are said to be in it, with their parameters.
    """

    left: Port
    right: Port
    geometry: Geometry
    dynamics: Mapping[str, Any] = field(default_factory=dict)
    effects: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def to_config(self) -> dict[str, Any]:
        """The keys of a plant file, which `drive_from_config` reads back."""
        own = self.geometry
        config: dict[str, Any] = {
            "kind": ROBOT_KIND,
            "left": self.left,
            "right": self.right,
            **{name: _rounded(getattr(own, name)) for name in _BASE},
            **{name: _rounded(value) for name in _OPTIONAL if (value := getattr(own, name))},
            **self.dynamics,
        }
        if self.effects:
            config["effects"] = {
                effect: {name: _rounded(value) for name, value in given.items()}
                for effect, given in self.effects.items()
            }
        return config


def drive_from_config(config: Mapping[str, Any]) -> DifferentialDrive:
    """Read a robot's keys; an effect of the geometry overrides the key that it is about.

    Raises:
        PlantError: a key, port, value or effect that is none, or one that is missing.
    """
    known = ("kind", "left", "right", *_BASE, *_OPTIONAL, *DYNAMIC_KEYS, "effects")
    _refuse_unknown(config, known, "plant")
    left, right = (_port(config, side) for side in ("left", "right"))
    if left == right:
        raise PlantError(f"both wheels are on port {left}", where="plant", mend="name two ports")
    radius_left, radius_right, track = (_length(config, name) for name in _BASE)
    effects = _effects(config)
    said = {
        "mean_wheel_radius_m": 0.5 * (radius_left + radius_right),
        "wheel_radius_ratio": radius_right / radius_left,
        "track_m": track,
        **{name: _number(config.get(name, 0.0), f"plant, {name}") for name in _OPTIONAL},
    }
    for effect, names in GEOMETRY_EFFECTS.items():
        said |= {name: value for name, value in effects.get(effect, {}).items() if name in names}
    dynamics = {name: config[name] for name in DYNAMIC_KEYS if name in config}
    return DifferentialDrive(left, right, Geometry(**said), dynamics, effects)


def _effects(config: Mapping[str, Any]) -> dict[str, Mapping[str, float]]:
    nested = config.get("effects") or {}
    if not isinstance(nested, Mapping):
        raise PlantError("is no mapping of effect ids", where="plant, effects")
    known = {**GEOMETRY_EFFECTS, **OTHER_EFFECTS, **DYNAMIC_EFFECTS}
    _refuse_unknown(nested, tuple(known), "plant, effects")
    found: dict[str, Mapping[str, float]] = {}
    for effect, given in nested.items():
        where = f"plant, effects, {effect}"
        if not isinstance(given, Mapping):
            raise PlantError("is no mapping of parameters", where=where)
        _refuse_unknown(given, known[str(effect)], where)
        found[str(effect)] = {str(name): _number(value, f"{where}, {name}") for name, value in given.items()}
    return found


def _port(config: Mapping[str, Any], side: str) -> Port:
    named = config.get(side)
    if named not in PORTS:
        mend = f"name the port of the {side} wheel's motor: {', '.join(PORTS)}"
        raise PlantError(
            "is missing" if named is None else f"'{named}' is no port", where=f"plant, {side}", mend=mend
        )
    return cast("Port", named)


def _length(config: Mapping[str, Any], name: str) -> float:
    if name not in config:
        raise PlantError("is missing", where=f"plant, {name}", mend="give it in m")
    value = _number(config[name], f"plant, {name}")
    if value <= 0.0:
        raise PlantError(f"{value} is not positive", where=f"plant, {name}", mend="give it in m")
    return value


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise PlantError(f"'{value}' is no finite number", where=where, mend="write a number")
    return float(value)


def _refuse_unknown(given: Mapping[Any, Any], known: Sequence[str], where: str) -> None:
    for key in sorted(map(str, set(given) - set(known))):
        near = difflib.get_close_matches(key, known, n=1)
        mend = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)}"
        raise PlantError(f"unknown key '{key}'", where=where, mend=mend)


def _rounded(value: float) -> float:
    return float(f"{value:.8g}")
