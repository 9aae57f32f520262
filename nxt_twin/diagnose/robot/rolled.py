"""How far the robot's body went by its measured pose, along and across its own heading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import PosePath


@final
@dataclass(frozen=True)
class BodyMotion:
    """Summed from row to row, each of shape (rows,).

    Attributes:
        along_m: travel of the axle's middle along the heading.
        aside_m: across it, to the left; noise alone where wheels do not slide sideways.
        heading_rad: the robot's heading.
    """

    along_m: FloatArray
    aside_m: FloatArray
    heading_rad: FloatArray

    def wheel_m(self, side: int, track_m: float) -> FloatArray:
        """Travel of the left (0) or the right (1) wheel's place on the floor."""
        return self.along_m + (side - 0.5) * track_m * self.heading_rad


def body_motion(pose: PosePath, geometry: Geometry) -> BodyMotion:
    """The motion of the axle's middle under the measured poses; short steps, so that fast turns are no matter."""
    heading = pose.heading_rad - np.radians(geometry.heading_offset_deg)
    lever = geometry.offset_forward_m + 1j * geometry.offset_left_m
    place = pose.x_m + 1j * pose.y_m - lever * np.exp(1j * heading)
    turn = np.diff(heading)
    step = np.diff(place) * np.exp(-1j * (heading[:-1] + 0.5 * turn))
    step = step / np.maximum(np.sinc(turn / (2.0 * np.pi)), 0.3)
    along, aside = (np.concatenate([[0.0], np.cumsum(part)]) for part in (step.real, step.imag))
    return BodyMotion(along, aside, heading)
