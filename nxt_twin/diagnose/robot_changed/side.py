"""One side of a comparison: its runs, fitted by themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray
from nxt_twin.diagnose.robot.held_out import FEWEST_RUNS, cut
from nxt_twin.diagnose.robot.runs import RobotRun, has_powers, robot_runs
from nxt_twin.diagnose.robot.search import RobotFindings, search
from nxt_twin.diagnose.robot.windows import PARAMETERS
from nxt_twin.diagnose.robot_changed.joint import FittedSide
from nxt_twin.diagnose.robot_changed.places import movable, movable_slopes
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.physics.robot.powered import is_powered
from nxt_twin.recording.case import Case

_PARTS = 4  # of equal time, into which each run of a side with few runs is cut


@final
@dataclass(frozen=True)
class RobotSide:
    """A side, and what its own runs say.

    Attributes:
        case: as it was given.
        runs: to fit, cut where there are few.
        held: not to fit.
        found: by its own runs.
        fitted: its numbers, as `places.MOVABLE`.
        told: which of a fit's parameters its paths can tell.
        powered: whether its recordings hold the powers that its model needs.
    """

    case: Case
    runs: tuple[RobotRun, ...]
    held: tuple[RobotRun, ...]
    found: RobotFindings
    fitted: FittedSide
    told: BoolArray
    powered: bool


def side_of(case: Case, drive: DifferentialDrive) -> RobotSide:
    """Fit a side by itself.

    Raises:
        DiagnosisError: it holds no recordings, or they lack wheels or pose.
    """
    if not case.recordings:
        raise DiagnosisError("lists no recording", where=case.name)
    runs, held = robot_runs(case.recordings, drive), robot_runs(case.holdout, drive)
    if len(runs) < FEWEST_RUNS:
        runs = tuple(part for run in runs for part in cut(run, _PARTS))
    found = search(runs, drive.geometry, lambda _: None)
    powered = is_powered(drive) and has_powers(case.recordings, drive)
    return RobotSide(case, runs, held, found, fitted_of(found), found.full.free, powered)


def fitted_of(found: RobotFindings) -> FittedSide:
    """A fit of everything as a side's numbers; sessions that disagree make it as doubtful as they are apart."""
    between = [found.spread[name].between if name in found.spread else 0.0 for name in PARAMETERS]
    covariance = found.full.covariance + np.diag(np.square(between))
    turn = movable_slopes(found.full.state.geometry)
    return FittedSide(movable(found.full.state.geometry), turn @ covariance @ turn.T, found.full.clusters)
