"""Parts as people write them: a solid in millimetres and grams, with its place, its turn and its colour."""

from __future__ import annotations

import math
from typing import Annotated, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from nxt_twin.world.assembly import Rgba, Shape, Vector, vector

PositiveSize = Annotated[float, Field(gt=0.0, le=1e5)]
Point = tuple[float, float, float]
Name = Annotated[str, Field(min_length=1, max_length=40)]

COLOURS: Final[dict[str, tuple[float, float, float]]] = {
    "white": (0.95, 0.95, 0.95),
    "light grey": (0.75, 0.76, 0.78),
    "grey": (0.5, 0.52, 0.55),
    "dark grey": (0.3, 0.31, 0.33),
    "black": (0.08, 0.08, 0.09),
    "red": (0.8, 0.1, 0.1),
    "orange": (0.95, 0.5, 0.1),
    "yellow": (0.95, 0.8, 0.1),
    "green": (0.1, 0.6, 0.25),
    "blue": (0.1, 0.25, 0.75),
    "wood": (0.72, 0.56, 0.38),
}
ColourName = Literal[
    "white", "light grey", "grey", "dark grey", "black", "red", "orange", "yellow", "green", "blue", "wood"
]


class Written(BaseModel):
    """What all that is written in a file has in common: nothing unknown, nothing infinite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Solid(Written):
    """A box, a cylinder or a sphere; give one of the three sizes.

    Attributes:
        box_mm: its edges along x, y, z.
        cylinder_mm: diameter and length; it stands along z until it is turned.
        sphere_mm: its diameter.
        at_mm: where its middle is.
        turned_deg: roll, pitch and yaw.
        colour: by name.
        solid: others collide with it.
    """

    box_mm: tuple[PositiveSize, PositiveSize, PositiveSize] | None = None
    cylinder_mm: tuple[PositiveSize, PositiveSize] | None = None
    sphere_mm: PositiveSize | None = None
    at_mm: Point = (0.0, 0.0, 0.0)
    turned_deg: Point = (0.0, 0.0, 0.0)
    colour: ColourName = "light grey"
    solid: bool = True

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        if sum(size is not None for size in (self.box_mm, self.cylinder_mm, self.sphere_mm)) != 1:
            raise ValueError("give one of box_mm, cylinder_mm and sphere_mm")
        return self

    def shape(self) -> Shape:
        """The solid in SI."""
        place, turn, paint = metres(self.at_mm), radians(self.turned_deg), painted(self.colour)
        if self.box_mm is not None:
            return Shape("box", metres(self.box_mm), place, turn, paint, solid=self.solid)
        if self.cylinder_mm is not None:
            diameter, length = self.cylinder_mm
            size = (0.5e-3 * diameter, 1e-3 * length)
            return Shape("cylinder", size, place, turn, paint, solid=self.solid)
        return Shape("sphere", (0.5e-3 * (self.sphere_mm or 0.0),), place, turn, paint, solid=self.solid)


def metres(place_mm: Point) -> Vector:
    """Millimetres in metres."""
    return vector(1e-3 * part for part in place_mm)


def radians(turned_deg: Point) -> Vector:
    """Degrees in radians."""
    return vector(math.radians(part) for part in turned_deg)


def painted(colour: ColourName) -> Rgba:
    """A colour by its name, opaque."""
    return (*COLOURS[colour], 1.0)
