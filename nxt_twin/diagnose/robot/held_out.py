"""Held-out predictions: of held-out recordings, or of each fold of recordings by a fit of the others."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import DrivenPath, HeldOutRun, Horizon
from nxt_twin.diagnose.robot.fit import FittedGeometry, fit_windows
from nxt_twin.diagnose.robot.hard_starts import hard_starts
from nxt_twin.diagnose.robot.judge import (
    METRES,
    MM,
    SECONDS,
    HorizonFigures,
    RobotModel,
    RunErrors,
    errors_of,
    figures,
    predicted,
)
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.search import RobotFindings, mend, refit, start_of, wheels_at
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.diagnose.robot.tellable import tellable
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import PosePath

FEWEST_RUNS: Final = 3  # recordings below which each is cut into parts
_FOLDS: Final = 4  # of the fitted runs, at most, that take turns where none is held out
_COMMON_SIGMAS: Final = 3.0  # standard deviations from zero above which a mean lag belongs to the model
_OWN_CLOCK_S: Final = 0.05  # shift of a run's own clock above which the clock may be at fault
_RUNS_OUT: Final = 2.0  # factor by which a clock of its own has to lower a run's RMSE to be at fault


@final
@dataclass(frozen=True)
class JudgedRun:
    """One run that was not fitted, with the models that did not see it.

    Attributes:
        run: the recording, as it was made.
        given, baseline, improved: as the model came, re-fitted, and with what was found.
        own_lag_s: the farthest that this run's clock is off, by a fit to this very run.
        errors: of these three, and of a model fitted to this very run with its clock: what is within reach.
        runs_out: whether it stays bad for a clock of its own.
    """

    run: RobotRun
    given: RobotModel
    baseline: RobotModel
    improved: RobotModel
    own_lag_s: float
    errors: tuple[RunErrors, RunErrors, RunErrors, RunErrors]
    runs_out: bool


def model_of(fitted: FittedGeometry) -> RobotModel:
    """A fit as a model; the lag that all recordings share goes along, lags of single ones do not."""
    lag_s = fitted.state.lag_s
    if not fitted.clock or lag_s.size < 2:
        return RobotModel(fitted.state.as_geometry, float(lag_s[0]) if fitted.clock else 0.0)
    doubt = max(float(lag_s.std(ddof=1)) / np.sqrt(lag_s.size), 1e-4)
    common = float(lag_s.mean()) if abs(lag_s.mean()) > _COMMON_SIGMAS * doubt else 0.0
    return RobotModel(fitted.state.as_geometry, common)


def cut(run: RobotRun, parts: int) -> list[RobotRun]:
    """One run as several of equal time, each beginning anew."""
    edges = np.linspace(run.time_s[0], run.time_s[-1], parts + 1)
    rows = np.searchsorted(run.time_s, edges)
    rows[-1] = run.time_s.size
    found = []
    for number, (begin, end) in enumerate(itertools.pairwise(rows), 1):
        part = slice(int(begin), int(end))
        pose = PosePath(run.pose.x_m[part], run.pose.y_m[part], run.pose.heading_rad[part])
        found.append(
            replace(
                run,
                name=f"{run.name} (part {number} of {parts})",
                session=f"{run.session} {number}",
                time_s=run.time_s[part],
                left_rad=run.left_rad[part],
                right_rad=run.right_rad[part],
                pose=pose,
            )
        )
    return found


def judge_held_out(
    fitted_runs: tuple[RobotRun, ...], held: tuple[RobotRun, ...], given: Geometry, found: RobotFindings
) -> list[JudgedRun]:
    """Judge on `held`; where none are held out, on each fold of the fitted runs by a fit of the others.

    Slip at hard starts is taken out of these runs too: no model of wheels and track predicts it.
    """
    if held:
        models = model_of(found.baseline), model_of(found.final)
        return [judged_run(run, given, *models) for run in _gripping(held, found)]
    judged, gripping = [], _gripping(fitted_runs, found)
    folds = min(_FOLDS, len(fitted_runs))
    for fold in range(folds):
        kept = tuple(run for index, run in enumerate(fitted_runs) if index % folds != fold)
        baseline, final = refit(kept, given, found, found.slips)
        judged += [
            judged_run(run, given, model_of(baseline), model_of(final))
            for index, run in enumerate(gripping)
            if index % folds == fold
        ]
    return judged


def _gripping(runs: tuple[RobotRun, ...], found: RobotFindings) -> tuple[RobotRun, ...]:
    """The runs without slip at hard starts, if the search found any."""
    if all(slip.lost is None for slip in found.slips):
        return runs
    return mend(runs, hard_starts(runs, found.final.state.as_geometry))


def judged_run(run: RobotRun, given: Geometry, baseline: RobotModel, improved: RobotModel) -> JudgedRun:
    """Judge models that saw nothing of a run, beside a fit to this very run.

    Args:
        run: as it was recorded.
        given: the geometry as the model came.
        baseline: another model.
        improved: another model.
    """
    own = fit_windows(stacked([run]), start_of(improved.geometry, 1), tellable([run]), clock=True)
    lag_s = float(np.abs(own.state.lag_s[0]) + np.abs(own.state.rate[0]) * 0.5 * run.duration_s)
    left, right = wheels_at(stacked([run]), own.state)[0]
    clocked = replace(run, left_rad=left, right_rad=right)
    ruler_m = given.mean_wheel_radius_m
    models = RobotModel(given), baseline, improved
    first, second, third = (errors_of(model, run, ruler_m) for model in models)
    reached = errors_of(RobotModel(own.state.as_geometry), clocked, ruler_m)
    mended = errors_of(RobotModel(improved.geometry), clocked, ruler_m)
    gains = max(_ratio(third.whole, mended.whole), _ratio(third.seconds, mended.seconds))
    runs_out = lag_s > _OWN_CLOCK_S and gains > _RUNS_OUT**2
    return JudgedRun(run, *models, lag_s, (first, second, third, reached), runs_out)


def _ratio(one: FloatArray, other: FloatArray) -> float:
    return float(np.mean(one) / np.mean(other)) if one.size and other.size else 0.0


def horizons_of(judged: Sequence[JudgedRun]) -> tuple[Horizon, ...]:
    """Errors at each horizon, mm: after seconds, after metres, over whole runs."""
    given, baseline, improved, own = (figures([one.errors[k] for one in judged]) for k in range(4))

    def errors(name: str) -> tuple[float, float, float, float]:
        values = [float(getattr(each, name)) for each in (given, baseline, improved, own)]
        return values[0], values[1], values[2], float(np.fmin(values[2], values[3]))

    found = [
        Horizon(SECONDS, *errors("seconds")),
        Horizon(_took(given), *errors("metres"), METRES),
        Horizon(None, *errors("whole")),
    ]
    return tuple(one for one in found if np.isfinite(one.improved))


def _took(given: HorizonFigures) -> float:
    return round(given.metre_s, 2)


def drawn_runs(judged: Sequence[JudgedRun]) -> tuple[HeldOutRun, ...]:
    """Each judged run with its errors over time and its path on the floor."""
    return tuple(_drawn(one) for one in judged)


def _drawn(one: JudgedRun) -> HeldOutRun:
    run = one.run
    told = [predicted(model, run) for model in (one.baseline, one.improved, one.given)]
    seen = _places(run.pose)
    far = [MM * np.hypot(*(_places(pose) - seen).T) for pose in told]
    speed = _speed(run, one.given.geometry.mean_wheel_radius_m)
    return HeldOutRun(
        recording=run.name,
        time_s=run.time_s,
        command=speed,
        command_label="speed of the wheels' middle (m/s)",
        measured=np.zeros(run.time_s.size),
        baseline=far[0],
        improved=far[1],
        stale=np.zeros(run.time_s.size),
        baseline_rmse=float(np.sqrt(np.mean(far[0] ** 2))),
        improved_rmse=float(np.sqrt(np.mean(far[1] ** 2))),
        path=DrivenPath(seen, _places(told[2]), _places(told[0]), _places(told[1])),
    )


def _places(pose: PosePath) -> FloatArray:
    return np.stack([pose.x_m, pose.y_m], axis=1)


def _speed(run: RobotRun, radius_m: float) -> FloatArray:
    """Of the axle's middle over a fifth of a second, m/s."""
    angle = 0.5 * (run.left_rad + run.right_rad)
    ahead, behind = (np.interp(run.time_s + shift, run.time_s, angle) for shift in (0.1, -0.1))
    return np.asarray(radius_m * (ahead - behind) / 0.2)
