"""The numbers of a robot that can differ after, and what may be named for them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.robot.drive import Geometry

MOVABLE: Final = (
    "left_wheel_radius_m",
    "right_wheel_radius_m",
    "track_m",
    "offset_forward_m",
    "offset_left_m",
    "heading_offset_deg",
)
"""The plant's own keys, in the order of a side's vector; a worn wheel is one of them."""

UNITS: Final = dict(zip(MOVABLE, ("m", "m", "m", "m", "m", "deg"), strict=True))


@final
@dataclass(frozen=True)
class ChangedPart:
    """Something that may have changed.

    Attributes:
        of: the plant's key, or an effect's id.
        places: of its numbers in a side's vector.
        matters: a smaller difference is not named; radii and track relative.
    """

    of: str
    places: tuple[int, ...]
    matters: tuple[float, ...]


CHANGED_PARTS: Final = (
    ChangedPart("left_wheel_radius_m", (0,), (1.5e-3,)),
    ChangedPart("right_wheel_radius_m", (1,), (1.5e-3,)),
    ChangedPart("track_m", (2,), (2e-3,)),
    ChangedPart("pose_offset", (3, 4, 5), (5e-4, 5e-4, 0.1)),
)


def movable(geometry: FloatArray) -> FloatArray:
    """A fit's vector (mean radius, ratio, track, markers) as `MOVABLE`, shape (6,)."""
    radius, ratio = geometry[:2]
    left = 2.0 * radius / (1.0 + ratio)
    return np.concatenate([[left, ratio * left], geometry[2:]])


def movable_slopes(geometry: FloatArray) -> FloatArray:
    """How `movable` moves with a fit's vector, shape (6, 6)."""
    radius, ratio = geometry[:2]
    found = np.eye(geometry.size)
    found[0, :2] = 2.0 / (1.0 + ratio), -2.0 * radius / (1.0 + ratio) ** 2
    found[1, :2] = 2.0 * ratio / (1.0 + ratio), 2.0 * radius / (1.0 + ratio) ** 2
    return found


def geometry_of(values: FloatArray) -> Geometry:
    """The geometry of a side's vector."""
    left, right, track, forward, aside, heading = values.tolist()
    return Geometry(0.5 * (left + right), right / left, track, forward, aside, heading)
