"""The pose that a robot's model expects along a recording, from its wheels and first pose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.robot.runs import wheels_of
from nxt_twin.errors import RecordingError
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.physics.robot.odometry import measured_path
from nxt_twin.recording.columns import POSE_HEADING, POSE_X, POSE_Y
from nxt_twin.recording.recording import Recording

_CHANNELS: Final = (POSE_X, POSE_Y, POSE_HEADING)


@final
@dataclass(frozen=True)
class ExpectedColumn:
    """One pose column as predicted at every row, beside what was measured.

    Attributes:
        channel: the column's name.
        values: shape (rows,), in `unit`.
        rmse: where a pose was measured and the prediction did not begin; None without any.
        readings: how many these are.
    """

    channel: str
    values: FloatArray
    unit: str
    rmse: float | None
    readings: int


def expected_pose(
    config: Mapping[str, Any], recording: Recording, restart_every_s: float | None
) -> tuple[ExpectedColumn, ...]:
    """Predict the pose from a recording's wheels; without any measured pose it begins at the origin.

    Args:
        config: the robot's keys.
        recording: with both wheels' tachos.
        restart_every_s: begin anew at the measured pose so often; None for the first alone.

    Raises:
        PlantError: a key or value that is none.
        DiagnosisError: a wheel's tacho is missing.
        RecordingError: poses to begin anew from are missing.
    """
    drive = drive_from_config(config)
    wheels = wheels_of(recording, drive)
    if lag_s := drive.effects.get("clock_skew", {}).get("lag_s", 0.0):
        then = recording.time_s - lag_s
        left, right = (np.interp(then, recording.time_s, wheel) for wheel in wheels)
    else:
        left, right = wheels
    measured = [recording.columns.get(name, np.full(recording.rows, np.nan)) for name in _CHANNELS]
    known = np.all(np.isfinite(measured), axis=0)
    if restart_every_s is not None and not known.any():
        raise RecordingError("holds no pose to begin anew from", where=recording.name)
    begins = _begins(recording.time_s, known, restart_every_s)
    columns = {name: np.empty(recording.rows) for name in _CHANNELS}
    for begin, end in zip(begins, [*begins[1:], recording.rows], strict=True):
        first = tuple(float(one[begin]) for one in measured) if known.any() else (0.0, 0.0, 0.0)
        part = slice(0 if begin == begins[0] else begin, end)
        path = measured_path(
            drive.geometry,
            left[part],
            right[part],
            (first[0], first[1], np.radians(first[2])),
            begin - part.start,
        )
        columns[POSE_X][part], columns[POSE_Y][part] = path.x_m, path.y_m
        columns[POSE_HEADING][part] = np.degrees(path.heading_rad)
    counted = known.copy()
    counted[begins] = False
    return tuple(
        _column(name, columns[name], one, counted) for name, one in zip(_CHANNELS, measured, strict=True)
    )


def _begins(time_s: FloatArray, known: BoolArray, every_s: float | None) -> list[int]:
    """Rows at which the prediction begins, the first of them the first that holds a pose."""
    rows = np.flatnonzero(known)
    if rows.size == 0:
        return [0]
    begins = [int(rows[0])]
    while every_s is not None:
        later = rows[time_s[rows] >= time_s[begins[-1]] + every_s - 1e-9]
        if later.size == 0:
            break
        begins.append(int(later[0]))
    return begins


def _column(name: str, predicted: FloatArray, measured: FloatArray, counted: BoolArray) -> ExpectedColumn:
    off = (predicted - measured)[counted]
    unit = "deg" if name == POSE_HEADING else "m"
    rmse = float(np.sqrt(np.mean(off**2))) if off.size else None
    return ExpectedColumn(name, predicted, unit, rmse, int(off.size))
