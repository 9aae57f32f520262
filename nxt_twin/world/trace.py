"""Where a robot was: what a world itself saw, whatever the program says."""

from __future__ import annotations

from pathlib import Path
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.columns import (
    BATTERY,
    DRIVE_MODES,
    PORTS,
    POSE_HEADING,
    POSE_X,
    POSE_Y,
    TIME,
    mode_column,
    power_column,
    tacho_column,
)
from nxt_twin.world.arena import Arena

_HUBS: Final = tuple(f"{port}_deg" for port in PORTS)
_POWERS: Final = tuple(power_column(port) for port in PORTS)
_MODES: Final = tuple(mode_column(port) for port in PORTS)
COLUMNS: Final = (
    "time_s",
    "x_m",
    "y_m",
    "z_m",
    "heading_deg",
    "pitch_deg",
    *_HUBS,
    *_POWERS,
    *_MODES,
    BATTERY,
)
EVERY_MS: Final = 20


@final
class Trace:
    """The robot's pose, hubs and powers from now on: a row every 20 ms of the world's time, and at each new power.

    Args:
        arena: the robot in its scene.
    """

    def __init__(self, arena: Arena) -> None:
        self._arena = arena
        self._rows: list[tuple[float, ...]] = []
        self._ticks = 0
        self._heading_deg = arena.robot_pose().heading_deg
        arena.watchers.append(self._watch)
        arena.body.motors.watchers.append(self._take)
        self._take()

    def _watch(self) -> None:
        self._ticks += 1
        if self._ticks % EVERY_MS == 0:
            self._take()

    def _take(self) -> None:
        pose = self._arena.robot_pose()
        turned = (pose.heading_deg - self._heading_deg + 180.0) % 360.0 - 180.0
        self._heading_deg += turned
        motors, place, time_s = self._arena.body.motors, pose.at_m.tolist(), self._arena.time_s
        hubs_deg, powers_pct = np.degrees(motors.angles_rad()), 100.0 * motors.duty
        if self._rows and self._rows[-1][0] == time_s:  # several bridges are set at one time
            self._rows.pop()
        self._rows.append(
            (
                time_s, *place, self._heading_deg, pose.pitch_deg, *hubs_deg.tolist(), *powers_pct.tolist(),
                *motors.mode.tolist(), self._arena.body.battery_v(),
            )
        )  # fmt: skip

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
        """Write it as a recording: whole counts, powers of what was driven, battery, and pose from where it began."""
        x, y = (self.column(name) for name in ("x_m", "y_m"))
        heading = self.column("heading_deg")
        turn = np.radians(heading[0])
        numbers = {TIME: self.column("time_s")}
        numbers |= {tacho_column(port): np.floor(self.column(f"{port}_deg")) for port in PORTS}
        numbers[POSE_X] = (x - x[0]) * np.cos(turn) + (y - y[0]) * np.sin(turn)
        numbers[POSE_Y] = (y - y[0]) * np.cos(turn) - (x - x[0]) * np.sin(turn)
        numbers[POSE_HEADING] = heading - heading[0]
        numbers[BATTERY] = self.column(BATTERY)
        cells = {name: [f"{value:.9g}" for value in values.tolist()] for name, values in numbers.items()}
        for power, mode in zip(_POWERS, _MODES, strict=True):
            powers = self.column(power).tolist()
            if any(powers):
                cells[power] = [f"{value:.9g}" for value in powers]
                cells[mode] = [DRIVE_MODES[int(value)] for value in self.column(mode).tolist()]
        lines = [",".join(cells), *(",".join(row) for row in zip(*cells.values(), strict=True))]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
