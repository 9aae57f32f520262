"""From wheels to pose: exact arcs between samples, for wheels that roll without slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.robot.drive import Geometry


@final
@dataclass(frozen=True)
class PosePath:
    """Places and headings along a run, each of shape (samples,); headings counter-clockwise, not wrapped."""

    x_m: FloatArray
    y_m: FloatArray
    heading_rad: FloatArray


def axle_path(geometry: Geometry, left_rad: FloatArray, right_rad: FloatArray) -> PosePath:
    """The path of the axle's middle from the origin, heading along x, as the wheels turn.

    Each wheel turns at a constant rate between samples, so that the path there is an arc.

    Args:
        geometry: the robot.
        left_rad: angle of the left wheel, shape (samples,).
        right_rad: of the right wheel.
    """
    left_m = geometry.left_wheel_radius_m * np.diff(left_rad)
    right_m = geometry.right_wheel_radius_m * np.diff(right_rad)
    return integrated(0.5 * (left_m + right_m), (right_m - left_m) / geometry.track_m)


def integrated(travel_m: FloatArray, turn_rad: FloatArray) -> PosePath:
    """The path from the origin that steps of travel and turn make, shape (steps + 1,)."""
    heading = np.concatenate([[0.0], np.cumsum(turn_rad)])
    chord = travel_m * np.sinc(turn_rad / (2.0 * np.pi))
    middle = heading[:-1] + 0.5 * turn_rad
    x_m = np.concatenate([[0.0], np.cumsum(chord * np.cos(middle))])
    y_m = np.concatenate([[0.0], np.cumsum(chord * np.sin(middle))])
    return PosePath(x_m, y_m, heading)


def measured_path(
    geometry: Geometry,
    left_rad: FloatArray,
    right_rad: FloatArray,
    known: tuple[float, float, float],
    at: int = 0,
) -> PosePath:
    """The poses that an outside camera would measure along a run, from one measured pose and the wheel angles.

    Args:
        geometry: the robot, and where on it the pose is measured.
        left_rad: angle of the left wheel, shape (samples,).
        right_rad: of the right wheel.
        known: x in m, y in m and heading in rad as measured at one sample.
        at: which sample that is.
    """
    path = axle_path(geometry, left_rad, right_rad)
    lever = geometry.offset_forward_m + 1j * geometry.offset_left_m
    seen = path.x_m + 1j * path.y_m + lever * np.exp(1j * path.heading_rad)
    turn = known[2] - np.radians(geometry.heading_offset_deg) - path.heading_rad[at]
    turned = (seen - seen[at]) * np.exp(1j * turn) + known[0] + 1j * known[1]
    return PosePath(turned.real, turned.imag, path.heading_rad - path.heading_rad[at] + known[2])
