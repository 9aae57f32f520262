"""Where a body is and how it is turned."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray


@final
@dataclass(frozen=True)
class Pose:
    """A frame in the world.

    Attributes:
        at_m: its origin, shape (3,).
        turn: rotation matrix from the frame to the world, shape (3, 3).
    """

    at_m: FloatArray
    turn: FloatArray

    def point(self, inside_m: FloatArray) -> FloatArray:
        """Points of the frame, in the world; shape (..., 3)."""
        return self.at_m + inside_m @ self.turn.T

    @property
    def heading_deg(self) -> float:
        """Where its x axis points on the floor, counter-clockwise from the world's, -180 to 180 deg."""
        return math.degrees(math.atan2(self.turn[1, 0], self.turn[0, 0]))

    @property
    def pitch_deg(self) -> float:
        """By how much its x axis dips below the horizon, deg."""
        return math.degrees(math.asin(-float(np.clip(self.turn[2, 0], -1.0, 1.0))))


def quaternion_to_matrix(quaternion: tuple[float, float, float, float]) -> FloatArray:
    """The rotation matrix of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@final
class Heading:
    """A heading over time, which goes on beyond half a turn."""

    def __init__(self) -> None:
        self._deg: float | None = None

    def of(self, pose: Pose) -> float:
        """The heading of the next pose, deg, not wrapped."""
        if self._deg is None:
            self._deg = pose.heading_deg
        self._deg += (pose.heading_deg - self._deg + 180.0) % 360.0 - 180.0
        return self._deg
