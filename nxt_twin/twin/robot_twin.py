"""A robot beside its ghost: told when they part, diagnosed, and watched on with what was found."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Final, final

from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.robot.engine import RobotAnswer, diagnose_robot
from nxt_twin.errors import NxtTwinError
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.recording.case import Case
from nxt_twin.twin.records import Event, EventKind
from nxt_twin.twin.wheel_ghost import RobotReading, WheelGhost, ghost_without_slip, recording_of

TOGETHER_M: Final = 0.5
"""After adoption the ghost has to hold for so long a way."""
GATHERED_S: Final = 12.0
"""A diagnosis needs so much driving; after one that named nothing, twice as much."""
CLEARLY: Final = 0.5
"""A model is taken over where its held-out error is below this share of the given model's."""
HARD_TIMES: Final = 2.0
"""Where wheels slip at hard starts, a diagnosis needs so many times the driving."""
LOST_S: Final = 0.4
"""Slip is located once it is over; so long a ghost may be lost before it counts."""
ROW_S: Final = 0.018
"""Readings that follow sooner are left out."""


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
        self._lost_s: float | None = None
        self._slipping = False
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
        if not self._apart and self._lost_for_long(reading, ghost):
            mended, spells = ghost_without_slip(self._rows, self.drive)
            if spells and not mended.lost():
                self._ghost, self._lost_s = mended, None
                said += self._slips(reading, spells)
            else:
                self._apart, self._adopted = True, False
                self._needed_s *= HARD_TIMES if spells else 1.0
                said.append(_event(reading, "divergence", f"robot and ghost are {where}"))
        elif self._adopted and not self._apart and ghost.path_m > TOGETHER_M:
            self._adopted = False
            said.append(_event(reading, "calm", f"robot and ghost are together again: {where}"))
        if self._apart and self._waiting is None and self._driven_s > self._needed_s:
            case = Case(
                "live", Path(), self.drive.to_config(), (recording_of(self._rows, self.drive),), (), None
            )
            self._waiting = self._executor.submit(diagnose_robot, case)
        return said

    def _lost_for_long(self, reading: RobotReading, ghost: WheelGhost) -> bool:
        if not ghost.lost():
            self._lost_s = None
            return False
        self._lost_s = reading.time_s if self._lost_s is None else self._lost_s
        return reading.time_s - self._lost_s >= LOST_S

    def _slips(self, reading: RobotReading, spells: int) -> list[Event]:
        """Told once: the ghost goes on without the counts that slipped."""
        if self._slipping:
            return []
        self._slipping = True
        words = f"the wheels slip at hard starts ({spells} so far); the ghost leaves out what slipped"
        return [_event(reading, "slip", words)]

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


def _clearly_better(said: Diagnosis) -> bool:
    """Short paths fit many explanations a little; only one that holds on unseen parts of them is worth adopting."""
    whole = said.fit.horizons[-1]
    return whole.improved < CLEARLY * whole.given


def _event(reading: RobotReading, kind: EventKind, words: str) -> Event:
    return Event(reading.time_s, kind, words)
