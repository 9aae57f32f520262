"""A robot's recordings made ready: wheel angles and measured pose on common rows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import PurePath
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import DiagnosisError
from nxt_twin.physics.robot.drive import DifferentialDrive
from nxt_twin.physics.robot.odometry import PosePath
from nxt_twin.recording.columns import POSE_HEADING, POSE_X, POSE_Y, Port, power_column, tacho_column
from nxt_twin.recording.recording import Recording

_FEWEST_ROWS: Final = 20  # with a pose, or with a wheel's count, below which a recording is refused
_LEAST_TRAVEL_RAD: Final = pi
_PIECES: Final = 200  # turns by wheels and by pose that are compared, at least, given enough rows
_TURNED_RAD: Final = pi / 3.0
_AGAINST: Final = -0.7  # correlation of turns by wheels and by pose below which a recording is refused
_POSE: Final = (POSE_X, POSE_Y, POSE_HEADING)


@final
@dataclass(frozen=True)
class RobotRun:
    """One recording, at the rows that hold a pose.

    Attributes:
        name: the recording's.
        session: what its name shares with recordings of one sitting (see `session_of`).
        time_s: stamps, shape (rows,), strictly rising.
        left_rad: angle of the left wheel since the first row, likewise.
        right_rad: of the right wheel.
        pose: as measured.
    """

    name: str
    session: str
    time_s: FloatArray
    left_rad: FloatArray
    right_rad: FloatArray
    pose: PosePath

    @property
    def first(self) -> tuple[float, float, float]:
        """The pose measured at the first row."""
        return float(self.pose.x_m[0]), float(self.pose.y_m[0]), float(self.pose.heading_rad[0])

    @property
    def duration_s(self) -> float:
        """From the first row to the last."""
        return float(self.time_s[-1] - self.time_s[0])


def robot_runs(recordings: Sequence[Recording], drive: DifferentialDrive) -> tuple[RobotRun, ...]:
    """Every recording made ready.

    Raises:
        DiagnosisError: a column is missing, or a recording holds too few poses or does not move.
    """
    return tuple(_run(recording, drive) for recording in recordings)


def filled_run(recording: Recording, drive: DifferentialDrive) -> RobotRun:
    """A recording at all its rows between the first and the last pose; poses that rows lack are interpolated.

    Raises:
        DiagnosisError: as `robot_runs`.
    """
    seen = _run(recording, drive)
    time_s = recording.time_s
    kept = (np.diff(time_s, prepend=-np.inf) > 0.0) & (time_s >= seen.time_s[0]) & (time_s <= seen.time_s[-1])
    left, right = (angle[kept] - angle[kept][0] for angle in wheels_of(recording, drive))
    told = (seen.pose.x_m, seen.pose.y_m, seen.pose.heading_rad)
    pose = PosePath(*(np.interp(time_s[kept], seen.time_s, each) for each in told))
    return RobotRun(seen.name, seen.session, time_s[kept], left, right, pose)


def session_of(name: str) -> str:
    """The name without its ending and its last number: `square_2306_01.csv` and `square_2306_02.csv` share one."""
    return re.sub(r"[_\- ]?\d+$", "", PurePath(name).with_suffix("").as_posix())


def wheels_of(recording: Recording, drive: DifferentialDrive) -> tuple[FloatArray, FloatArray]:
    """Angles of the left and the right wheel at every row, rad; counts that a row lacks are interpolated.

    Raises:
        DiagnosisError: a wheel's tacho column is missing or empty.
    """
    left, right = (_wheel(recording, port) for port in (drive.left, drive.right))
    return left, right


def _run(recording: Recording, drive: DifferentialDrive) -> RobotRun:
    columns = recording.columns
    missing = [name for name in _POSE if name not in columns or not np.isfinite(columns[name]).any()]
    if missing:
        what = f"{', '.join(missing)} missing: without a pose from outside, wheels and track cannot be told"
        raise DiagnosisError(
            what, where=recording.name, mend="record the pose with a camera or by tape measure"
        )
    left, right = wheels_of(recording, drive)
    fresh = np.diff(recording.time_s, prepend=-np.inf) > 0.0
    kept = fresh & np.all([np.isfinite(columns[name]) for name in _POSE], axis=0)
    if np.count_nonzero(kept) < _FEWEST_ROWS:
        what = f"holds {np.count_nonzero(kept)} rows with a pose, fewer than {_FEWEST_ROWS}"
        raise DiagnosisError(what, where=recording.name, mend="record the pose in every row")
    left, right = left[kept] - left[kept][0], right[kept] - right[kept][0]
    if max(np.ptp(left), np.ptp(right)) < _LEAST_TRAVEL_RAD:
        what = "its wheels turn less than half a turn"
        raise DiagnosisError(what, where=recording.name, mend="record a run in which the robot drives")
    heading = np.unwrap(np.radians(columns[POSE_HEADING][kept]))
    _check_sense(recording, left - right, heading)
    pose = PosePath(columns[POSE_X][kept], columns[POSE_Y][kept], heading)
    return RobotRun(recording.name, session_of(recording.name), recording.time_s[kept], left, right, pose)


def _check_sense(recording: Recording, apart_rad: FloatArray, heading_rad: FloatArray) -> None:
    """Refuse a pose that turns the other way round than the wheels: no physics does that.

    Args:
        recording: to be named.
        apart_rad: angle of the left wheel minus that of the right one.
        heading_rad: as measured, unwrapped.
    """
    pieces = slice(None, None, max(1, apart_rad.size // _PIECES))
    by_wheels, seen = np.diff(-apart_rad[pieces]), np.diff(heading_rad[pieces])
    size = float(np.sqrt((by_wheels @ by_wheels) * (seen @ seen)))
    if np.ptp(heading_rad) > _TURNED_RAD and size > 0.0 and float(by_wheels @ seen) < _AGAINST * size:
        what = "its pose turns the other way round than its wheels"
        mend = (
            "exchange `left` and `right` in the plant; or, where the heading grows clockwise or y points to the right, "
            "change their signs"
        )
        raise DiagnosisError(what, where=recording.name, mend=mend)


def _wheel(recording: Recording, port: Port) -> FloatArray:
    name = tacho_column(port)
    counts = recording.columns.get(name)
    known = np.isfinite(counts) if counts is not None else np.zeros(0, dtype=bool)
    if counts is None or not known.any():
        others = [each for each in recording.columns if each.endswith("_tacho_deg") and each != name]
        mend = (
            f"record both wheels, or name their ports in the plant; it has {', '.join(others) or 'no tacho'}"
        )
        raise DiagnosisError(f"{name} is missing or empty", where=recording.name, mend=mend)
    if np.count_nonzero(known) < _FEWEST_ROWS:
        what = f"{name} holds {np.count_nonzero(known)} counts, fewer than {_FEWEST_ROWS}"
        raise DiagnosisError(what, where=recording.name, mend="record for longer, or more often")
    return np.radians(np.interp(recording.time_s, recording.time_s[known], counts[known]))


def has_powers(recordings: Sequence[Recording], drive: DifferentialDrive) -> bool:
    """Whether every recording tells what both motors were commanded."""
    names = [power_column(port) for port in (drive.left, drive.right)]
    return all(name in recording.columns for recording in recordings for name in names)
