"""Whether the spells of slip that were found bring the paths together, as slip does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.robot.judge import HorizonFigures, RobotModel, errors_of, figures
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.physics.robot.drive import Geometry

LEAST_FALL: Final = 0.8
"""Slip lowers the error of whole runs or of 2 s to such a share; a bent picture does not (seeds 800 to 811)."""

Wheels = Sequence[tuple[FloatArray, FloatArray]]


def brings_together(runs: Sequence[RobotRun], geometry: Geometry, slipping: Wheels, gripping: Wheels) -> bool:
    """Whether predicted paths come clearly nearer the poses where the slipped angles are taken out.

    Args:
        runs: those with spells of slip.
        geometry: fitted with the slip taken out.
        slipping: angles of each run's wheels with the slip in them, when the poses were taken.
        gripping: likewise without it.
    """
    before, after = (_errors(runs, geometry, wheels) for wheels in (slipping, gripping))
    return after.whole < LEAST_FALL * before.whole or after.seconds < LEAST_FALL * before.seconds


def _errors(runs: Sequence[RobotRun], geometry: Geometry, wheels: Wheels) -> HorizonFigures:
    rolled = [
        replace(run, left_rad=left, right_rad=right) for run, (left, right) in zip(runs, wheels, strict=True)
    ]
    model = RobotModel(geometry)
    return figures([errors_of(model, run, geometry.mean_wheel_radius_m) for run in rolled])
