"""A robot beside its ghost: the pose that a model of its wheels has, by their counts alone, from one seen pose on."""

from __future__ import annotations

import cmath
import math
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import numpy as np

from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.robot.engine import RobotAnswer, diagnose_robot
from nxt_twin.errors import NxtTwinError
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.recording.case import Case
from nxt_twin.recording.columns import POSE_HEADING, POSE_X, POSE_Y, tacho_column
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.records import Event, EventKind

APART_M: Final = 0.010
APART_PER_M: Final = 0.03
"""Robot and ghost are apart from a distance on that grows with the way since they were together."""
APART_DEG: Final = 5.0
APART_PER_DEG: Final = 0.01
TOGETHER_M: Final = 0.5
"""After adoption the ghost has to hold for so long a way."""
GATHERED_S: Final = 12.0
"""A diagnosis needs so much driving; after one that named nothing, twice as much."""
CLEARLY: Final = 0.5
"""A model is taken over where its held-out error is below this share of the given model's."""
ROW_S: Final = 0.018
"""Readings that follow sooner are left out."""


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


@final
class RobotTwin:
    """Watches a robot and its ghost, diagnoses why they part, adopts what is found, and watches on.

    Args:
        drive: the model of its wheels.
        executor: where a diagnosis runs.

    Attributes:
        drive: the model in force.
        ghosts: how many ghosts have begun: a model that is taken over begins a new one.
    """

    def __init__(self, drive: DifferentialDrive, executor: Executor) -> None:
        self.drive = drive
        self.ghosts = 0
        self._executor = executor
        self._rows: list[RobotReading] = []
        self._ghost: WheelGhost | None = None
        self._driven_s = 0.0
        self._needed_s = GATHERED_S
        self._apart = self._adopted = False
        self._waiting: Future[RobotAnswer] | None = None

    @property
    def ghost_pose(self) -> tuple[float, float, float] | None:
        """Where the ghost is: x, y (m) and heading (deg); None before the first reading."""
        return None if self._ghost is None else self._ghost.pose

    def see(self, reading: RobotReading) -> list[Event]:
        """Take a reading; what is to be said of it."""
        last = self._rows[-1] if self._rows else None
        if last is not None and reading.time_s - last.time_s < ROW_S:
            return []
        self._rows.append(reading)
        if last is None or self._ghost is None:
            self._begin(reading)
            return []
        if (reading.left_deg, reading.right_deg) != (last.left_deg, last.right_deg):
            self._driven_s += reading.time_s - last.time_s
        self._ghost.follow(reading)
        return [*self._answered(reading), *self._compared(reading, self._ghost)]

    def _compared(self, reading: RobotReading, ghost: WheelGhost) -> list[Event]:
        away_m, turned_deg = ghost.apart()
        where = f"{1e3 * away_m:.0f} mm and {abs(turned_deg):.1f}° apart after {ghost.path_m:.2f} m"
        said: list[Event] = []
        if not self._apart and ghost.lost():
            self._apart, self._adopted = True, False
            said.append(_event(reading, "divergence", f"robot and ghost are {where}"))
        elif self._adopted and not self._apart and ghost.path_m > TOGETHER_M:
            self._adopted = False
            said.append(_event(reading, "calm", f"robot and ghost are together again: {where}"))
        if self._apart and self._waiting is None and self._driven_s > self._needed_s:
            case = Case("live", Path(), self.drive.to_config(), (self._recording(),), (), None)
            self._waiting = self._executor.submit(diagnose_robot, case)
        return said

    def _answered(self, reading: RobotReading) -> list[Event]:
        if self._waiting is None or not self._waiting.done():
            return []
        waiting, self._waiting = self._waiting, None
        self._needed_s = 2.0 * self._driven_s
        try:
            answer = waiting.result()
        except NxtTwinError as error:
            return [_event(reading, "undiagnosed", f"the robot's path is not diagnosed: {error}")]
        if answer.diagnosis.verdict != "explained" or not _clearly_better(answer.diagnosis):
            return [_event(reading, "undiagnosed", answer.diagnosis.sentence)]
        return self._adopt(answer, reading)

    def _adopt(self, answer: RobotAnswer, reading: RobotReading) -> list[Event]:
        """Take over the model, and set the ghost where the robot is."""
        self.drive = answer.model
        self._begin(reading)
        self._rows, self._driven_s, self._needed_s = [reading], 0.0, GATHERED_S
        self._apart, self._adopted = False, True
        names = ", ".join(effect.id for effect in answer.diagnosis.effects)
        return [
            _event(reading, "effect_named", answer.diagnosis.sentence),
            _event(reading, "adopted", f"the robot's model now holds {names}; the ghost starts at the robot"),
        ]

    def _begin(self, reading: RobotReading) -> None:
        self._ghost = WheelGhost(self.drive, reading)
        self.ghosts += 1

    def _recording(self) -> Recording:
        rows, first = self._rows, self._rows[0]
        columns = {
            "time_s": [row.time_s for row in rows],
            tacho_column(self.drive.left): [row.left_deg for row in rows],
            tacho_column(self.drive.right): [row.right_deg for row in rows],
            POSE_X: [row.x_m - first.x_m for row in rows],
            POSE_Y: [row.y_m - first.y_m for row in rows],
            POSE_HEADING: [row.heading_deg for row in rows],
        }
        return Recording("live", {name: np.array(values) for name, values in columns.items()})


def _clearly_better(said: Diagnosis) -> bool:
    """Short paths fit many explanations a little; only one that holds on unseen parts of them is worth adopting."""
    whole = said.fit.horizons[-1]
    return whole.improved < CLEARLY * whole.given


def _event(reading: RobotReading, kind: EventKind, words: str) -> Event:
    return Event(reading.time_s, kind, words)
