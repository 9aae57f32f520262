"""The effects of wheels, markers and clocks, one declaration each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, Literal, final

from nxt_twin.physics.effect import Equation

WheelSide = Literal["left", "right"]


@final
@dataclass(frozen=True)
class RobotEffect:
    """Something that a robot's model may leave out.

    Attributes:
        id: the contract's name.
        motor: the side of the one motor that has it, if it is a motor's.
        name: in words.
        equation: the law in plain text.
        fails: the equation in which it shows.
        units: of its parameters, by name.
        confusable_with: ids of effects that look alike, with the path that separates them.
    """

    id: str
    name: str
    equation: str
    fails: Equation
    units: Mapping[str, str]
    confusable_with: Mapping[str, str] = field(default_factory=dict)
    motor: WheelSide | None = None

    @property
    def key(self) -> str:
        """Its id, behind the motor that has it: ``left_motor.voltage_drop``."""
        return f"{self.motor}_motor.{self.id}" if self.motor else self.id


WHEEL_RADIUS: Final = RobotEffect(
    "wheel_radius",
    "wheels of another radius",
    "travel = mean_wheel_radius · (left angle + right angle) / 2",
    "kinematic",
    {"mean_wheel_radius_m": "m"},
    {"wheel_slip": "slip comes in spells, a wrong radius acts all the time"},
)
UNEQUAL_WHEELS: Final = RobotEffect(
    "unequal_wheels",
    "unequal wheels",
    "right radius = wheel_radius_ratio · left radius, so that equal angles turn the robot",
    "kinematic",
    {"wheel_radius_ratio": "1"},
    {
        "wrong_track": "a path that turns both ways: the ratio errs one way, the track with the direction",
        "pose_offset": "drive two headings and measure the direction of travel: turned markers do not bend the path",
    },
)
WRONG_TRACK: Final = RobotEffect(
    "wrong_track",
    "another effective track",
    "turn = (right travel − left travel) / track",
    "kinematic",
    {"track_m": "m"},
    {
        "unequal_wheels": "a path that turns both ways: the ratio errs one way, the track with the direction",
        "wheel_radius": "drive straight for a metre: travel depends on the radius alone",
    },
)
POSE_OFFSET: Final = RobotEffect(
    "pose_offset",
    "the markers' place or heading on the robot",
    "measured place = axle's middle + offset turned by the heading; measured heading = heading + heading_offset",
    "measurement",
    {"offset_forward_m": "m", "offset_left_m": "m", "heading_offset_deg": "deg"},
    {"unequal_wheels": "turned markers do not bend the path: drive straight for two metres"},
)
CLOCK_SKEW: Final = RobotEffect(
    "clock_skew",
    "the pose's clock beside the wheels'",
    "pose(t) belongs to wheels(t − lag − rate_error · t), with a lag of each recording's own",
    "timing",
    {"lag_s": "s", "lag_span_s": "s", "rate_error": "1"},
    {"pose_offset": "change speed often: a lag moves the place with the speed, an offset does not"},
)
WHEEL_SLIP: Final = RobotEffect(
    "wheel_slip",
    "slipping wheels",
    "travel = (1 − slip_ratio) · radius · angle, in spells",
    "kinematic",
    {"slip_ratio": "1"},
    {"clock_skew": "stop for two seconds: what a lag displaces comes back, what slipped does not"},
)

CASTER_DRAG: Final = RobotEffect(
    "caster_drag",
    "a caster that drags",
    "force on the caster = −drag_force · direction of its motion",
    "torque_balance",
    {"drag_force_n": "N"},
    {"floor_slope": "drive to two headings: a slope changes its sign, a drag does not"},
)
FLOOR_SLOPE: Final = RobotEffect(
    "floor_slope",
    "a floor that is not level",
    "force = −mass · g · sin(slope), along uphill_heading",
    "torque_balance",
    {"slope_deg": "deg", "uphill_heading_deg": "deg"},
    {"caster_drag": "drive to two headings: a slope changes its sign, a drag does not"},
)
PAYLOAD_MASS: Final = RobotEffect(
    "payload_mass",
    "a payload",
    "mass = the body's + added_mass",
    "torque_balance",
    {"added_mass_kg": "kg"},
    {"caster_drag": "start and stop often: a mass resists only changes of speed"},
)
CENTRE_OF_MASS: Final = RobotEffect(
    "centre_of_mass_offset",
    "a centre of mass beside the axle's middle",
    "torque = −mass · offset × acceleration, so that starting straight turns the robot",
    "torque_balance",
    {"offset_left_m": "m", "offset_forward_m": "m"},
    {"payload_mass": "start and stop straight: an offset to a side turns the robot, a payload does not"},
)

BATTERY_SAG: Final = RobotEffect(
    "battery_sag",
    "a battery that sags",
    "supply = open circuit − internal_resistance · current of both motors",
    "electrical",
    {"internal_resistance_ohm": "Ω"},
    {"payload_mass": "read the battery's voltage while both motors start: only a weak battery falls"},
)


def _of_motor(side: WheelSide) -> tuple[RobotEffect, ...]:
    """The effects that one motor may have of its own."""
    return (
        RobotEffect(
            "asymmetric_friction",
            f"friction that differs by direction in the {side} motor",
            "torque = −coulomb_forward · sign(speed) forward, −coulomb_reverse · sign(speed) in reverse",
            "torque_balance",
            {"coulomb_forward_nm": "N·m", "coulomb_reverse_nm": "N·m"},
            motor=side,
        ),
        RobotEffect(
            "quadratic_drag",
            f"drag that grows with the square of the speed on the {side} motor",
            "torque = −quadratic_drag · speed · |speed|",
            "torque_balance",
            {"quadratic_drag_nm_s2_per_rad2": "N·m·s²/rad²"},
            motor=side,
        ),
        RobotEffect(
            "voltage_drop",
            f"a voltage drop in the circuit of the {side} motor",
            "voltage across the winding = voltage − back-emf − drop · sign(current)",
            "electrical",
            {"drop_v": "V"},
            motor=side,
        ),
    )


POWERED: Final = (
    CASTER_DRAG,
    FLOOR_SLOPE,
    PAYLOAD_MASS,
    CENTRE_OF_MASS,
    BATTERY_SAG,
    *_of_motor("left"),
    *_of_motor("right"),
)
"""Effects of body, floor, battery and motors, which need the motors' powers to be seen."""

GEOMETRY: Final = (WHEEL_RADIUS, UNEQUAL_WHEELS, WRONG_TRACK, POSE_OFFSET)
"""Effects that are parameters of the geometry, which all recordings share."""

LIBRARY: Final[Mapping[str, RobotEffect]] = MappingProxyType(
    {effect.key: effect for effect in (*GEOMETRY, CLOCK_SKEW, WHEEL_SLIP, *POWERED)}
)
