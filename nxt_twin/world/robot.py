"""A robot as people write it: parts, wheels on motors, glides, arms and sensors. Lengths in mm, masses in g.

Its frame lies on the floor under the middle of the axle: x ahead, y to the left, z up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Final, Literal, final

from pydantic import Field, ValidationInfo, field_validator

from nxt_twin.recording.columns import Port
from nxt_twin.world.assembly import Assembly, Grip, Joint, RigidLink, Shape, lumped
from nxt_twin.world.geared import geared, relieved
from nxt_twin.world.parts import Name, Point, PositiveSize, Solid, Written, metres, painted
from nxt_twin.world.sensing import SensorMount

BASE: Final = "base"
_TYRE_SHARE: Final = 0.75
"""A wheel's moment of inertia by m·r²: between a disc (0.5) and a hoop (1)."""


@final
class Part(Solid):
    """A part that is fixed to the body.

    Attributes:
        mass_g: its mass.
        name: what it is, for people.
    """

    mass_g: PositiveSize
    name: str = ""

    def weighed(self) -> tuple[Shape, float]:
        """The solid and its mass in kg."""
        return self.shape(), 1e-3 * self.mass_g


@final
class Wheel(Written):
    """A wheel on a motor's hub, turning about y.

    Attributes:
        port: the motor's.
        at_mm: its middle.
        radius_mm, width_mm, mass_g: of wheel and tyre.
        friction: of the tyre on a floor of friction 1.
        scrub_mm: torque against turning on the spot, by the load, as an arm.
        rolling_mm: torque against rolling, by the load, as an arm.
        reversed: the motor is mounted the other way round: its forward turns the wheel backward.
    """

    port: Port
    at_mm: Point
    radius_mm: PositiveSize
    width_mm: PositiveSize = 26.0
    mass_g: PositiveSize = 30.0
    friction: Annotated[float, Field(ge=0.0, le=5.0)] = 0.9
    scrub_mm: Annotated[float, Field(ge=0.0, le=100.0)] = 2.0
    rolling_mm: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    reversed: bool = False

    def link(self, name: str) -> RigidLink:
        """The wheel: a sphere to the floor, a cylinder to the eye.

        A wide cylinder touches the floor along a line, which pulls a straight course sideways by two per cent.
        """
        radius_m, mass_kg = 1e-3 * self.radius_mm, 1e-3 * self.mass_g
        spin = _TYRE_SHARE * mass_kg * radius_m**2
        across = 0.5 * spin + mass_kg * (1e-3 * self.width_mm) ** 2 / 12.0
        tyre, side = painted("black"), (0.5 * math.pi, 0.0, 0.0)
        rim = (0.7 * radius_m, 1.02e-3 * self.width_mm)
        spoke = (1.2 * radius_m, 1.03e-3 * self.width_mm, 0.25 * radius_m)
        shapes = (
            Shape("sphere", (radius_m,), seen=False),
            Shape("cylinder", (radius_m, 1e-3 * self.width_mm), turned_rad=side, colour=tyre, solid=False),
            Shape("cylinder", rim, turned_rad=side, colour=painted("light grey"), solid=False),
            Shape("box", spoke, colour=painted("dark grey"), solid=False),
        )
        joint = Joint("hinge", metres(self.at_mm), (0.0, -1.0 if self.reversed else 1.0, 0.0))
        grip = Grip(self.friction, 1e-3 * self.scrub_mm, 1e-3 * self.rolling_mm)
        return RigidLink(name, shapes, mass_kg, (0.0, 0.0, 0.0), (across, spin, across), grip, joint)


@final
class Glide(Written):
    """A support that glides, such as a castor; its swivelling is left out.

    Attributes:
        at_mm: its middle.
        radius_mm, mass_g: of the ball that it is.
        friction: on a floor of friction 1.
    """

    at_mm: Point
    radius_mm: PositiveSize = 8.0
    mass_g: PositiveSize = 10.0
    friction: Annotated[float, Field(ge=0.0, le=5.0)] = 0.04

    def link(self, name: str) -> RigidLink:
        """A ball that is held so that it does not turn."""
        shape = Shape("sphere", (1e-3 * self.radius_mm,), colour=painted("dark grey"))
        joint = Joint("fixed", metres(self.at_mm), (0.0, 0.0, 1.0))
        return lumped(name, [(shape, 1e-3 * self.mass_g)], Grip(self.friction), joint)


@final
class Arm(Written):
    """Parts that a motor turns.

    Attributes:
        port: the motor's.
        at_mm: the hub.
        axis: the axis about which it turns forward, right-handed.
        parts: with their places from the hub.
        range_deg: how far it goes either way; None is free.
        friction: of its surface.
    """

    port: Port
    at_mm: Point
    axis: Literal["x", "y", "z", "-x", "-y", "-z"] = "y"
    parts: Annotated[list[Part], Field(min_length=1)]
    range_deg: tuple[float, float] | None = None
    friction: Annotated[float, Field(ge=0.0, le=5.0)] = 0.4

    def link(self, name: str) -> RigidLink:
        """The arm."""
        axis = unit_vector(self.axis)
        limits = (
            None
            if self.range_deg is None
            else (math.radians(self.range_deg[0]), math.radians(self.range_deg[1]))
        )
        joint = Joint("hinge", metres(self.at_mm), axis, limits)
        return lumped(name, [part.weighed() for part in self.parts], Grip(self.friction), joint)


@final
class Robot(Written):
    """A robot.

    Attributes:
        name: for people.
        parts: fixed to one another.
        wheels, glides, arms: what turns or slides on it, by name.
        sensors: on the brick's ports.
        friction: of its body's surface.
        fixed: it is screwed to the bench.
    """

    name: Name
    parts: Annotated[list[Part], Field(min_length=1)]
    wheels: dict[Name, Wheel] = Field(default_factory=dict)
    glides: dict[Name, Glide] = Field(default_factory=dict)
    arms: dict[Name, Arm] = Field(default_factory=dict)
    sensors: dict[Literal[1, 2, 3, 4], SensorMount] = Field(default_factory=dict)
    friction: Annotated[float, Field(ge=0.0, le=5.0)] = 0.4
    fixed: bool = False

    @field_validator("wheels", "arms")
    @classmethod
    def _one_a_motor(
        cls, turning: dict[str, Wheel] | dict[str, Arm], info: ValidationInfo
    ) -> dict[str, Wheel] | dict[str, Arm]:
        taken = {wheel.port: name for name, wheel in info.data.get("wheels", {}).items()}
        for name, part in turning.items():
            other = taken.setdefault(part.port, name)
            if other != name:
                raise ValueError(
                    f"{other} and {name} are on one port, {part.port}; each needs a motor of its own"
                )
        return turning

    @property
    def motors(self) -> dict[Port, str]:
        """The names of what turns, by the ports of their motors."""
        return {part.port: name for name, part in self._turning}

    def assembly(self, motor_inertia_kg_m2: Mapping[Port, float]) -> Assembly:
        """The robot's bodies.

        Args:
            motor_inertia_kg_m2: what the motors' gear trains add about their hubs, by port.
        """
        base = lumped(BASE, [part.weighed() for part in self.parts], Grip(self.friction))
        hubs = [(part.link(name), motor_inertia_kg_m2[part.port]) for name, part in self._turning]
        trains = [geared(link, inertia) for link, inertia in hubs]
        lighter = relieved(base, [(link.joint, inertia) for link, inertia in hubs if link.joint is not None])
        gliding = [glide.link(name) for name, glide in self.glides.items()]
        plungers = [
            sensor.plunger(plunger_name(port))
            for port, sensor in self.sensors.items()
            if sensor.kind == "touch"
        ]
        turning = [link for hub, rotor, _ in trains for link in (hub, rotor)]
        links = (lighter, *turning, *gliding, *plungers)
        return Assembly(self.name, links, tuple(gear for *_, gear in trains), self.fixed)

    @property
    def _turning(self) -> list[tuple[str, Wheel | Arm]]:
        return [*self.wheels.items(), *self.arms.items()]


def plunger_name(port: int) -> str:
    """The name of a touch sensor's link."""
    return f"sensor {port}"


def unit_vector(name: str) -> tuple[float, float, float]:
    """The unit vector of an axis such as ``-y``."""
    sign = -1.0 if name.startswith("-") else 1.0
    x, y, z = (sign * float(name[-1] == letter) for letter in "xyz")
    return x, y, z
