"""A robot's ghost: where a model of its two wheels has it, by what its encoders counted."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.physics.robot.odometry import axle_path
from nxt_twin.world.trace import Trace


def ghost_of(course: Trace, drive: DifferentialDrive) -> FloatArray:
    """The ghost's x, y (m) and heading (rad) in the world at each row of a course, shape (rows, 3).

    It starts where the robot did, and then knows nothing but whole counts.
    """
    counts = (np.floor(course.column(f"{port}_deg")) for port in (drive.left, drive.right))
    left, right = (np.radians(each) for each in counts)
    path = axle_path(drive.geometry, left, right)
    start = np.radians(course.column("heading_deg")[0])
    x, y = course.places_m[0]
    return np.column_stack(
        [
            x + path.x_m * np.cos(start) - path.y_m * np.sin(start),
            y + path.x_m * np.sin(start) + path.y_m * np.cos(start),
            start + path.heading_rad,
        ]
    )
