"""Where a robot was: what a world itself saw, whatever the program says."""

from __future__ import annotations

from pathlib import Path
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.columns import PORTS
from nxt_twin.world.arena import Arena

COLUMNS: Final = ("time_s", "x_m", "y_m", "z_m", "heading_deg", "pitch_deg", "a_deg", "b_deg", "c_deg")
EVERY_MS: Final = 20


@final
class Trace:
    """The robot's pose and hubs, a row every 20 ms of the world's time from now on.

    Args:
        arena: the robot in its scene.
    """

    def __init__(self, arena: Arena) -> None:
        self._arena = arena
        self._rows: list[tuple[float, ...]] = []
        self._ticks = 0
        self._heading_deg = arena.robot_pose().heading_deg
        arena.watchers.append(self._watch)
        self._take()

    def _watch(self) -> None:
        self._ticks += 1
        if self._ticks % EVERY_MS == 0:
            self._take()

    def _take(self) -> None:
        pose = self._arena.robot_pose()
        turned = (pose.heading_deg - self._heading_deg + 180.0) % 360.0 - 180.0
        self._heading_deg += turned
        hubs_deg = np.degrees(self._arena.body.motors.angles_rad())
        place = pose.at_m.tolist()
        self._rows.append((self._arena.time_s, *place, self._heading_deg, pose.pitch_deg, *hubs_deg.tolist()))

    def column(self, name: str) -> FloatArray:
        """A column by its name in `COLUMNS`, shape (rows,); the heading is not wrapped."""
        return np.array([row[COLUMNS.index(name)] for row in self._rows])

    @property
    def places_m(self) -> FloatArray:
        """Where the robot was on the floor, shape (rows, 2)."""
        return np.array([row[1:3] for row in self._rows])

    @property
    def path_m(self) -> float:
        """How far it went, m."""
        return float(np.sum(np.hypot(*np.diff(self.places_m, axis=0).T)))

    def write(self, path: Path) -> None:
        """Write it as a recording: whole counts of all encoders, and the pose from where it began."""
        x, y = (self.column(name) for name in ("x_m", "y_m"))
        heading = self.column("heading_deg")
        turn = np.radians(heading[0])
        ahead = (x - x[0]) * np.cos(turn) + (y - y[0]) * np.sin(turn)
        left = (y - y[0]) * np.cos(turn) - (x - x[0]) * np.sin(turn)
        counts = [np.floor(self.column(f"{port}_deg")) for port in PORTS]
        rows = np.column_stack([self.column("time_s"), *counts, ahead, left, heading - heading[0]])
        head = (
            "time_s",
            *(f"{port}_tacho_deg" for port in PORTS),
            "pose_x_m",
            "pose_y_m",
            "pose_heading_deg",
        )
        lines = [",".join(head), *(",".join(f"{value:.9g}" for value in row) for row in rows.tolist())]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
