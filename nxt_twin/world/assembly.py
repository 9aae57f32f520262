"""Bodies as an engine takes them: links of shapes, with masses, held together by joints; no engine is named here."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, final

import numpy as np

from nxt_twin.arrays import FloatArray

Vector = tuple[float, float, float]
Rgba = tuple[float, float, float, float]
ORIGIN: Vector = (0.0, 0.0, 0.0)


@final
@dataclass(frozen=True)
class Shape:
    """A solid in its link's frame.

    Attributes:
        kind: what it is.
        size_m: of a box its edges; of a cylinder, along z before it is turned, radius and length; of a sphere its
            radius.
        at_m: its middle.
        turned_rad: roll, pitch, yaw.
        colour: red, green, blue and opacity, 0 to 1.
        seen: it is drawn.
        solid: others collide with it.
    """

    kind: Literal["box", "cylinder", "sphere"]
    size_m: tuple[float, ...]
    at_m: Vector = ORIGIN
    turned_rad: Vector = ORIGIN
    colour: Rgba = (0.7, 0.7, 0.7, 1.0)
    seen: bool = True
    solid: bool = True

    def inertia(self, mass_kg: float) -> FloatArray:
        """Moments about its own middle along its link's axes (kg·m²), of an even density; products are left out."""
        match self.kind:
            case "box":
                x, y, z = (edge**2 for edge in self.size_m)
                own = np.array([y + z, x + z, x + y]) * mass_kg / 12.0
            case "cylinder":
                radius, length = self.size_m
                across = mass_kg * (3.0 * radius**2 + length**2) / 12.0
                own = np.array([across, across, 0.5 * mass_kg * radius**2])
            case "sphere":
                own = np.full(3, 0.4 * mass_kg * self.size_m[0] ** 2)
        turn = rotation(self.turned_rad)
        moments: FloatArray = np.diag(turn @ np.diag(own) @ turn.T).copy()
        return moments


@final
@dataclass(frozen=True)
class Grip:
    """How a link's surface holds on to another's; what counts in a contact is the product of both.

    Attributes:
        sliding: coefficient of friction.
        spinning_m: torque about the contact's normal, by the normal force.
        rolling_m: torque against rolling, by the normal force.
    """

    sliding: float = 0.5
    spinning_m: float = 0.0
    rolling_m: float = 0.0


@final
@dataclass(frozen=True)
class Joint:
    """How a link hangs on the base.

    Attributes:
        kind: turning about an axis, sliding along it, or neither.
        at_m: the link's origin in the base's frame.
        axis: unit vector in the base's frame.
        limits: lowest and highest place (rad or m); None is free.
    """

    kind: Literal["hinge", "slide", "fixed"]
    at_m: Vector
    axis: Vector
    limits: tuple[float, float] | None = None


@final
@dataclass(frozen=True)
class RigidLink:
    """A rigid body.

    Attributes:
        name: unique in its assembly.
        shapes: in its own frame.
        mass_kg, centre_m, inertia_kg_m2: its mass, where that is, and the moments about that along its own axes.
        grip: of its surface.
        joint: None for the base.
    """

    name: str
    shapes: tuple[Shape, ...]
    mass_kg: float
    centre_m: Vector
    inertia_kg_m2: Vector
    grip: Grip = Grip()
    joint: Joint | None = None


@final
@dataclass(frozen=True)
class Gear:
    """Makes one hinge turn at a fixed ratio to another: angle of `follower` = ratio · angle of `leader`."""

    leader: str
    follower: str
    ratio: float


@final
@dataclass(frozen=True)
class Assembly:
    """A base and what hangs on it, the base's frame as its own.

    Attributes:
        name: for people.
        links: the base first.
        gears: between hinges.
        fixed: the base does not move.
    """

    name: str
    links: tuple[RigidLink, ...]
    gears: tuple[Gear, ...] = ()
    fixed: bool = False

    @property
    def mass_kg(self) -> float:
        """Of all links."""
        return sum(link.mass_kg for link in self.links)

    @property
    def centre_m(self) -> Vector:
        """The centre of mass in the base's frame, with all joints at rest."""
        weighted = [
            link.mass_kg * (np.array(link.centre_m) + (link.joint.at_m if link.joint else ORIGIN))
            for link in self.links
        ]
        return vector(sum(weighted, np.zeros(3)) / self.mass_kg)


def lumped(
    name: str, parts: Iterable[tuple[Shape, float]], grip: Grip = Grip(), joint: Joint | None = None
) -> RigidLink:
    """One link of several shapes, each with its mass (kg)."""
    shapes, masses = zip(*parts, strict=True)
    mass = sum(masses)
    centre = sum((m * np.array(s.at_m) for s, m in zip(shapes, masses, strict=True)), np.zeros(3)) / mass
    moments = np.zeros(3)
    for shape, part_kg in zip(shapes, masses, strict=True):
        x, y, z = (np.array(shape.at_m) - centre) ** 2
        moments += shape.inertia(part_kg) + part_kg * np.array([y + z, x + z, x + y])
    return RigidLink(name, tuple(shapes), mass, vector(centre), vector(moments), grip, joint)


def vector(values: Iterable[float]) -> Vector:
    """Three numbers as a vector."""
    x, y, z = (float(value) for value in values)
    return x, y, z


def rotation(turned_rad: Vector) -> FloatArray:
    """The matrix that turns by roll about x, then pitch about y, then yaw about z, all of the frame outside."""
    (cr, cp, cy), (sr, sp, sy) = ([f(a) for a in turned_rad] for f in (math.cos, math.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
