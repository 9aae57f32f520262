"""Runs one after another in arrays, cut into windows whose start poses are free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import ComplexArray, FloatArray, IntArray
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import integrated

_APART_S: Final = 1e5  # between runs, on one common axis of time
_MOST_ROWS: Final = 24_000  # that a fit needs; from twice this number on, rows are thinned


@final
@dataclass(frozen=True)
class PoseWindows:
    """Parts of equal length, none overlapping, that together hold every row.

    Attributes:
        first: the row at which each begins, shape (windows,).
        counts: how many rows each holds.
        of_row: which window each row is in, shape (rows,).
    """

    first: IntArray
    counts: IntArray
    of_row: IntArray


@final
@dataclass(frozen=True)
class RunStack:
    """All rows of several runs.

    Attributes:
        runs: them.
        run: which run each row belongs to, shape (rows,).
        time_s: on an axis on which runs lie far apart.
        phase: from -1 at a run's first row to 1 at its last.
        left_rad, right_rad: wheel angles.
        place: measured x + i·y, m.
        heading_rad: measured heading.
        half_s: half of each run's length, shape (runs,).
    """

    runs: tuple[RobotRun, ...]
    run: IntArray
    time_s: FloatArray
    phase: FloatArray
    left_rad: FloatArray
    right_rad: FloatArray
    place: ComplexArray
    heading_rad: FloatArray
    half_s: FloatArray

    def wheels(self, lag_s: FloatArray, rate: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Wheel angles as they were when the poses were taken, if poses lag by `lag_s` + `rate`·time.

        Args:
            lag_s: of each run at its middle, shape (runs,); positive where the pose is older than its row.
            rate: its growth over time, shape (runs,).
        """
        if not (lag_s.any() or rate.any()):
            return self.left_rad, self.right_rad
        late = lag_s[self.run] + (rate * self.half_s)[self.run] * self.phase
        then = self.time_s - late
        return np.interp(then, self.time_s, self.left_rad), np.interp(then, self.time_s, self.right_rad)

    def path(
        self, geometry: Geometry, left_rad: FloatArray, right_rad: FloatArray
    ) -> tuple[ComplexArray, FloatArray]:
        """Place (x + i·y) and heading of the measured point as the wheels tell; each run goes on from the last."""
        left_m = geometry.left_wheel_radius_m * np.diff(left_rad)
        right_m = geometry.right_wheel_radius_m * np.diff(right_rad)
        between = np.diff(self.run) != 0
        left_m[between] = right_m[between] = 0.0
        path = integrated(0.5 * (left_m + right_m), (right_m - left_m) / geometry.track_m)
        lever = geometry.offset_forward_m + 1j * geometry.offset_left_m
        place = path.x_m + 1j * path.y_m + lever * np.exp(1j * path.heading_rad)
        return place, path.heading_rad + np.radians(geometry.heading_offset_deg)

    def windows(self, length_s: float) -> PoseWindows:
        """PoseWindows of about `length_s`, a whole number of them in each run."""
        number = np.zeros(self.run.size, dtype=np.int64)
        total = 0
        for index, run in enumerate(self.runs):
            rows = np.flatnonzero(self.run == index)
            parts = max(1, round(run.duration_s / length_s))
            share = 0.5 * (self.phase[rows] + 1.0)
            number[rows] = total + np.minimum((share * parts).astype(np.int64), parts - 1)
            total += parts
        _, first, counts = np.unique(number, return_index=True, return_counts=True)
        return PoseWindows(first, counts, np.repeat(np.arange(first.size), counts))


def stacked(runs: Sequence[RobotRun]) -> RunStack:
    """The runs in one stack, rows thinned evenly where there are more than a fit needs."""
    every = max(1, sum(run.time_s.size for run in runs) // _MOST_ROWS)
    sizes = [run.time_s[::every].size for run in runs]
    times = [run.time_s[::every] - run.time_s[0] for run in runs]
    half_s = np.array([0.5 * time[-1] for time in times])
    return RunStack(
        runs=tuple(runs),
        run=np.repeat(np.arange(len(runs)), sizes),
        time_s=np.concatenate([time + _APART_S * index for index, time in enumerate(times)]),
        phase=np.concatenate([time / half - 1.0 for time, half in zip(times, half_s, strict=True)]),
        left_rad=np.concatenate([run.left_rad[::every] for run in runs]),
        right_rad=np.concatenate([run.right_rad[::every] for run in runs]),
        place=np.concatenate([(run.pose.x_m + 1j * run.pose.y_m)[::every] for run in runs]),
        heading_rad=np.concatenate([run.pose.heading_rad[::every] for run in runs]),
        half_s=half_s,
    )
