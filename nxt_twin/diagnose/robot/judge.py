"""How far models are from poses that were not fitted, begun at one measured pose: after seconds, metres, whole runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import PosePath, axle_path, measured_path

SECONDS: Final = 2.0  # length of the windows that tell the error after seconds
METRES: Final = 1.0  # travel of the windows that tell the error after metres
MM: Final = 1e3  # in a metre


@final
@dataclass(frozen=True)
class RobotModel:
    """A robot's geometry, and by how much its poses lag behind its wheels."""

    geometry: Geometry
    lag_s: float = 0.0


@final
@dataclass(frozen=True)
class RunErrors:
    """Squared position errors of one run, m²: at every row from its first pose, and at the ends of windows."""

    whole: FloatArray
    seconds: FloatArray
    metres: FloatArray
    metre_s: float


def predicted(model: RobotModel, run: RobotRun) -> PosePath:
    """The measured pose that a model expects along a run, from its wheels and its first pose alone."""
    return measured_path(model.geometry, *_wheels(model, run), run.first)


def errors_of(model: RobotModel, run: RobotRun, ruler_m: float) -> RunErrors:
    """How far a model is from one run's poses.

    Args:
        model: the robot.
        run: the recording.
        ruler_m: wheel radius by which metres are counted, one for all models that are compared.
    """
    left, right = _wheels(model, run)
    path = axle_path(model.geometry, left, right)
    lever = model.geometry.offset_forward_m + 1j * model.geometry.offset_left_m
    told = path.x_m + 1j * path.y_m + lever * np.exp(1j * path.heading_rad)
    heading = path.heading_rad + np.radians(model.geometry.heading_offset_deg)
    seen = run.pose.x_m + 1j * run.pose.y_m

    def at_ends(edges: IntArray) -> FloatArray:
        begin, end = edges[:-1], edges[1:]
        turned = (told[end] - told[begin]) * np.exp(1j * (run.pose.heading_rad - heading)[begin])
        return np.asarray(np.abs(seen[end] - seen[begin] - turned) ** 2)

    first = (told - told[0]) * np.exp(1j * (run.pose.heading_rad[0] - heading[0])) + seen[0]
    steps = 0.5 * ruler_m * np.abs(np.diff(run.left_rad + run.right_rad))
    by_metre = _edges(np.concatenate([[0.0], np.cumsum(steps)]), METRES)
    took_s = np.diff(run.time_s[by_metre])
    return RunErrors(
        np.abs(seen - first) ** 2,
        at_ends(_edges(run.time_s - run.time_s[0], SECONDS)),
        at_ends(by_metre),
        float(took_s.mean()) if took_s.size else np.nan,
    )


@final
@dataclass(frozen=True)
class HorizonFigures:
    """RMSE of position over several runs, mm; NaN where no window was that long."""

    whole: float
    seconds: float
    metres: float
    metre_s: float


def figures(each: Sequence[RunErrors]) -> HorizonFigures:
    """Runs together, every row and every window alike."""

    def rms(parts: list[FloatArray]) -> float:
        values = np.concatenate(parts) if parts else np.zeros(0)
        return MM * float(np.sqrt(values.mean())) if values.size else float("nan")

    took = [errors.metre_s for errors in each if np.isfinite(errors.metre_s)]
    return HorizonFigures(
        rms([errors.whole for errors in each]),
        rms([errors.seconds for errors in each]),
        rms([errors.metres for errors in each]),
        float(np.mean(took)) if took else float("nan"),
    )


def _wheels(model: RobotModel, run: RobotRun) -> tuple[FloatArray, FloatArray]:
    if model.lag_s == 0.0:
        return run.left_rad, run.right_rad
    then = run.time_s - model.lag_s
    return np.interp(then, run.time_s, run.left_rad), np.interp(then, run.time_s, run.right_rad)


def _edges(along: FloatArray, length: float) -> IntArray:
    """The rows at which each whole multiple of `length` is reached; what is left over is left out."""
    marks = np.arange(0.0, along[-1] + 1e-9, length)
    return np.asarray(np.searchsorted(along, marks - 1e-9), dtype=np.int64)
