"""Robots on two wheels: what a diagnosis of ten minutes costs, and how far a real robot's model is from unseen runs."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.blind.robot.bench import case_of_world
from nxt_twin.blind.robot.world import make_world
from nxt_twin.diagnose.robot.engine import diagnose_robot, robot_of
from nxt_twin.diagnose.robot.fit import fit_windows
from nxt_twin.diagnose.robot.judge import RobotModel, errors_of, figures
from nxt_twin.diagnose.robot.runs import RobotRun, robot_runs
from nxt_twin.diagnose.robot.search import start_of, wheels_at
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.diagnose.robot.windows import PARAMETERS
from nxt_twin.errors import MissingDataError
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.recording.case import Case, read_case
from nxt_twin.recording.realdata import data_root

_SEED: Final = 12
_TIMES: Final = 4
_REAL: Final = "robot-optiodom"
_BAD_CLOCKS: Final = ("square_231220200029_02", "free_030120210001_02")
"""Runs of the data set whose clocks are known to be cut wrong: figures are given with them and without."""


def report() -> list[str]:
    """Processor time of a diagnosis, and held-out errors on the real robot where its data is on this machine."""
    return [*_cost(), *_real()]


def _cost() -> list[str]:
    case = case_of_world(make_world(("wrong_track",), _SEED), _SEED)
    runs = tuple(
        replace(run, name=f"{n}-{run.name}")
        for n in range(_TIMES)
        for run in (*case.recordings, *case.holdout)
    )
    minutes = sum(run.duration_s for run in runs) / 60.0
    began_s = time.process_time()
    said = diagnose_robot(replace(case, recordings=runs, holdout=())).diagnosis
    taken_s = time.process_time() - began_s
    named = ", ".join(effect.id for effect in said.effects) or "nothing"
    return [f"{minutes:.1f} min in {len(runs)} recordings: {taken_s:.1f} s of processor time; named: {named}"]


def _real() -> list[str]:
    try:
        folder = data_root() / _REAL
    except MissingDataError as missing:
        return [str(missing)]
    if not folder.is_dir():
        return [f"{_REAL} is not on this machine"]
    case = read_case(folder)
    models = (("given", robot_of(case)), ("improved", diagnose_robot(case).model))
    runs = robot_runs(case.holdout, robot_of(case))
    good = [run for run in runs if not any(bad in run.name for bad in _BAD_CLOCKS)]
    late = [run for run in runs if any(bad in run.name for bad in _BAD_CLOCKS)]
    clocked = [_with_its_clock(run, models[1][1]) for run in runs]
    return (
        [f"{_REAL}, held-out position RMSE; aims: whole runs 18 mm, after 1 m 7.5 mm"]
        + [
            _line(f"{name}, {len(chosen)} runs", model, chosen, case)
            for name, model in models
            for chosen in (runs, good)
        ]
        + [_line(f"improved, {run.name} as recorded", models[1][1], [run], case) for run in late]
        + [_line("improved, 38 runs, each by its own clock's lag and rate", models[1][1], clocked, case)]
    )


def _with_its_clock(run: RobotRun, drive: DifferentialDrive) -> RobotRun:
    """The run with its wheels read when its poses were taken: only lag and rate are fitted to it, no geometry."""
    stack, fixed = stacked([run]), np.zeros(len(PARAMETERS), dtype=bool)
    fitted = fit_windows(stack, start_of(drive.geometry, 1), fixed, clock=True)
    left, right = wheels_at(stack, fitted.state)[0]
    return replace(run, left_rad=left, right_rad=right)


def _line(name: str, drive: DifferentialDrive, runs: Sequence[RobotRun], case: Case) -> str:
    """Errors of a model from the wheels and the first pose; runs are begun without any clock's lag."""
    ruler_m = robot_of(case).geometry.mean_wheel_radius_m
    rmse = figures([errors_of(RobotModel(drive.geometry), run, ruler_m) for run in runs])
    return f"{name}: whole runs {rmse.whole:.1f} mm, after 1 m {rmse.metres:.1f} mm, after 2 s {rmse.seconds:.2f} mm"


if __name__ == "__main__":
    print("\n".join(report()))
