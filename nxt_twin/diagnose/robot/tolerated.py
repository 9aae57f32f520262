"""Effects that show, and yet move a robot's path by less than matters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.robot.choice import places_of
from nxt_twin.diagnose.robot.effects import CLOCK_SKEW, LIBRARY, WHEEL_SLIP
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.search import RobotFindings, mend, wheels_at
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.diagnose.robot.windows import DriveState, vector_of
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import measured_path

Wheels = list[tuple[FloatArray, FloatArray]]
Rolled = Callable[[int], tuple[Geometry, FloatArray, FloatArray]]


@final
@dataclass(frozen=True)
class PathShifts:
    """How far paths move where an effect is left out: RMS distance over whole runs, m, by the effect's id."""

    of: dict[str, float]

    def below(self, tolerance_m: float | None) -> dict[str, float]:
        """The effects that move paths by less than a tolerance; without one, none."""
        return {} if tolerance_m is None else {one: far for one, far in self.of.items() if far < tolerance_m}


def path_shifts(found: RobotFindings, given: Geometry) -> PathShifts:
    """Leave each named effect of wheels, markers, clocks and slip out in turn."""
    geometry = found.final.state.as_geometry
    runs = stacked(mend(found.runs, found.slips)).runs
    clocked = wheels_at(stacked(runs), found.final.state)
    shifts = {}
    for effect in found.choice.named:
        values = vector_of(geometry)
        values[places_of(LIBRARY[effect.id])] = vector_of(given)[places_of(LIBRARY[effect.id])]
        without = DriveState(values, np.zeros(0), np.zeros(0)).as_geometry
        shifts[effect.id] = _apart(runs, _held(geometry, clocked), _held(without, clocked))
    if found.final.clock:
        plain: Wheels = [(run.left_rad, run.right_rad) for run in runs]
        shifts[CLOCK_SKEW.id] = _apart(runs, _held(geometry, clocked), _held(geometry, plain))
    if found.slips:
        slipped = wheels_at(stacked(found.runs), found.final.state)
        shifts[WHEEL_SLIP.id] = _apart(runs, _held(geometry, clocked), _held(geometry, slipped))
    return PathShifts(shifts)


def _held(geometry: Geometry, wheels: Wheels) -> Rolled:
    return lambda n: (geometry, *wheels[n])


def _apart(runs: tuple[RobotRun, ...], one: Rolled, other: Rolled) -> float:
    """RMS distance of two predictions, each begun at the first measured pose."""
    squares = []
    for n, run in enumerate(runs):
        first, second = (measured_path(*rolled(n), run.first) for rolled in (one, other))
        squares.append((first.x_m - second.x_m) ** 2 + (first.y_m - second.y_m) ** 2)
    return float(np.sqrt(np.mean(np.concatenate(squares))))
