"""The pose that a model of a robot's wheels has, by their counts alone, from one seen pose on."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from nxt_twin.diagnose.robot.hard_starts import hard_starts
from nxt_twin.diagnose.robot.runs import robot_runs
from nxt_twin.diagnose.robot.search import mend
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.recording.columns import POSE_HEADING, POSE_X, POSE_Y, tacho_column
from nxt_twin.recording.recording import Recording

APART_M: Final = 0.010
APART_PER_M: Final = 0.03
"""Robot and ghost are apart from a distance on that grows with the way since they were together."""
APART_DEG: Final = 5.0
APART_PER_DEG: Final = 0.01


@final
@dataclass(frozen=True)
class RobotReading:
    """Where a robot is, as somebody outside sees it, and what its wheels counted (deg).

    Attributes:
        time_s: when, s since the session began.
        left_deg: count of the left wheel.
        right_deg: count of the right wheel.
        x_m: place.
        y_m: place.
        heading_deg: not wrapped.
    """

    time_s: float
    left_deg: float
    right_deg: float
    x_m: float
    y_m: float
    heading_deg: float


@final
class WheelGhost:
    """A pose by wheels alone.

    Args:
        drive: the model.
        start: where it begins.
    """

    def __init__(self, drive: DifferentialDrive, start: RobotReading) -> None:
        self._geometry, self._last = drive.geometry, start
        self._lever = drive.geometry.offset_forward_m + 1j * drive.geometry.offset_left_m
        self._turn = math.radians(start.heading_deg - drive.geometry.heading_offset_deg)
        self._axle = complex(start.x_m, start.y_m) - self._lever * cmath.rect(1.0, self._turn)
        self.path_m = self.turned_deg = 0.0

    def follow(self, reading: RobotReading) -> None:
        """Move as the wheels did since the last reading."""
        left, right = (
            math.radians(after - before) * radius
            for after, before, radius in (
                (reading.left_deg, self._last.left_deg, self._geometry.left_wheel_radius_m),
                (reading.right_deg, self._last.right_deg, self._geometry.right_wheel_radius_m),
            )
        )
        turn, travel = (right - left) / self._geometry.track_m, 0.5 * (left + right)
        chord = travel * float(np.sinc(turn / (2.0 * math.pi)))
        self._axle += cmath.rect(chord, self._turn + 0.5 * turn)
        self._turn += turn
        self._last = reading
        self.path_m += abs(travel)
        self.turned_deg += abs(math.degrees(turn))

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where it expects the robot to be seen: x, y (m) and heading (deg)."""
        seen = self._axle + self._lever * cmath.rect(1.0, self._turn)
        return seen.real, seen.imag, math.degrees(self._turn) + self._geometry.heading_offset_deg

    def keep_up(self, reading: RobotReading) -> None:
        """Go on from a robot whose counts were mended until now: later turns count from its raw reading."""
        self._last = reading

    def apart(self) -> tuple[float, float]:
        """How far from the robot it is (m), and by how much the robot is turned further (deg)."""
        x_m, y_m, heading_deg = self.pose
        away_m = math.hypot(self._last.x_m - x_m, self._last.y_m - y_m)
        return away_m, self._last.heading_deg - heading_deg

    def lost(self) -> bool:
        """Whether robot and ghost are apart."""
        away_m, turned_deg = self.apart()
        far = away_m > APART_M + APART_PER_M * self.path_m
        return far or abs(turned_deg) > APART_DEG + APART_PER_DEG * self.turned_deg


def recording_of(rows: Sequence[RobotReading], drive: DifferentialDrive) -> Recording:
    """The readings as a recording, with places from the first on."""
    first = rows[0]
    columns = {
        "time_s": [row.time_s for row in rows],
        tacho_column(drive.left): [row.left_deg for row in rows],
        tacho_column(drive.right): [row.right_deg for row in rows],
        POSE_X: [row.x_m - first.x_m for row in rows],
        POSE_Y: [row.y_m - first.y_m for row in rows],
        POSE_HEADING: [row.heading_deg for row in rows],
    }
    return Recording("live", {name: np.array(values) for name, values in columns.items()})


def ghost_without_slip(rows: Sequence[RobotReading], drive: DifferentialDrive) -> tuple[WheelGhost, int]:
    """A ghost that leaves out what slipped at hard starts, and how many such spells there were.

    Args:
        rows: from where the ghost begins.
        drive: the model.
    """
    try:
        runs = robot_runs([recording_of(rows, drive)], drive)
    except DiagnosisError:  # it has hardly driven yet
        runs = ()
    spells = hard_starts(runs, drive.geometry)
    first = rows[0]
    ghost = WheelGhost(drive, first)
    for run in mend(runs, spells):
        turned = np.degrees([run.left_rad, run.right_rad]).T.tolist()
        for row, (left, right) in zip(rows, turned, strict=True):
            ghost.follow(replace(row, left_deg=first.left_deg + left, right_deg=first.right_deg + right))
    ghost.keep_up(rows[-1])
    return ghost, len(spells)
