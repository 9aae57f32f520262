"""A robot's world for the live dashboard: its bodies, told once, and where they are, told over and over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray

_SCENERY: Final = "s"
_MOMENT: Final = "w"
_FINEST_FLOOR: Final = 160
"""Spots along an edge of the floor's picture: it travels as text."""

SceneFrame = tuple[float, ...]
"""Of a body: place x, y, z (m) and quaternion x, y, z, w."""


@final
@dataclass(frozen=True)
class DrawnShape:
    """A solid in its body's frame.

    Attributes:
        kind: box, cylinder or sphere.
        size_m: edges, radius and length, or radius.
        at_m: its middle.
        turned_rad: roll, pitch, yaw.
        colour: red, green, blue, opacity, 0 to 1.
        seen: whether it is drawn.
    """

    kind: str
    size_m: tuple[float, ...]
    at_m: tuple[float, float, float]
    turned_rad: tuple[float, float, float]
    colour: tuple[float, float, float, float]
    seen: bool = True


@final
@dataclass(frozen=True)
class Scenery:
    """All that is in a world.

    Attributes:
        floor_m: size of the floor's picture along x and y, its middle at the origin.
        shades: of that picture, 0 to 255, along x and then y.
        bodies: names such as ``robot/base``, each with its solids; the first is the robot's base.
    """

    floor_m: tuple[float, float]
    shades: tuple[tuple[int, ...], ...]
    bodies: tuple[tuple[str, tuple[DrawnShape, ...]], ...]


@final
@dataclass(frozen=True)
class WorldMoment:
    """A world at one moment.

    Attributes:
        time_s: s since the session began.
        frames: of the scenery's bodies, in their order.
        echoes_m: the ways of the last echoes: start x, y, z and end x, y, z.
        ghost: where the twin has the robot by its wheels alone: x, y (m) and heading (rad); None before it has begun.
        ghosts: how many ghosts have begun so far; a model that is taken over begins a new one.
    """

    time_s: float
    frames: tuple[SceneFrame, ...]
    echoes_m: tuple[SceneFrame, ...] = ()
    ghost: tuple[float, float, float] | None = None
    ghosts: int = 1


WorldMessage = Scenery | WorldMoment


def coarse(shades: FloatArray) -> tuple[tuple[int, ...], ...]:
    """A floor's shades, 0 to 1, as a picture that is small enough to travel."""
    every = max(1, -(-max(shades.shape) // _FINEST_FLOOR))
    grey = np.round(255.0 * np.clip(shades[::every, ::every], 0.0, 1.0)).astype(int)
    return tuple(tuple(row) for row in grey.tolist())


def plain_values(message: WorldMessage) -> tuple[object, ...]:
    """A message as plain values."""
    if isinstance(message, Scenery):
        bodies = [(name, [tuple(vars(one).values()) for one in shapes]) for name, shapes in message.bodies]
        return (_SCENERY, message.floor_m, message.shades, bodies)
    return (_MOMENT, *vars(message).values())


def message_of(kind: str, row: Sequence[Any]) -> WorldMessage | None:
    """What `plain_values` made plain; None if it is something else."""
    if kind == _SCENERY:
        floor_m, shades, bodies = row
        drawn = tuple((name, tuple(_shape(one) for one in shapes)) for name, shapes in bodies)
        return Scenery(tuple(floor_m), tuple(map(tuple, shades)), drawn)
    if kind == _MOMENT:
        time_s, frames, echoes_m, ghost, ghosts = row
        place = None if ghost is None else tuple(ghost)
        return WorldMoment(time_s, tuple(map(tuple, frames)), tuple(map(tuple, echoes_m)), place, ghosts)
    return None


def _shape(row: Sequence[Any]) -> DrawnShape:
    kind, size_m, at_m, turned_rad, colour, seen = row
    return DrawnShape(kind, tuple(size_m), tuple(at_m), tuple(turned_rad), tuple(colour), seen)
