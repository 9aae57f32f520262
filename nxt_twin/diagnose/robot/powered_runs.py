"""A robot's recordings with the powers of its motors, cut into windows with free starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.robot.runs import filled_run
from nxt_twin.diagnose.robot.slip import SlipSpell, gripping
from nxt_twin.physics.robot.drive import DifferentialDrive, Geometry
from nxt_twin.physics.robot.dynamics import NAMES
from nxt_twin.physics.robot.powered import PoweredRobot
from nxt_twin.physics.robot.slopes import COLUMNS, STARTS, wheel_slopes
from nxt_twin.physics.supply import open_circuit
from nxt_twin.recording.columns import BATTERY, DRIVE_MODES, Port, mode_column, power_column
from nxt_twin.recording.recording import Recording

_SMOOTH_S: Final = 0.12  # to either side of a row, over which a wheel's speed is a difference of angles
_APART_S: Final = 100.0  # between the beginnings of two runs on their common axis of time
_HALF: Final = 0.5  # share of the time between two rows above which a motor counts as let go
_DRAG: Final = NAMES.index("drag_force")
_FEWEST_READINGS: Final = 4  # of the battery, below which the supply is their median and no line of time


@final
@dataclass(frozen=True)
class PoweredStack:
    """Rows of several runs one after another.

    Attributes:
        run: index of each row's run, or part of a run, shape (rows,).
        time_s: on an axis on which runs lie apart.
        volts: at both motors from each row on, shape (rows, 2); NaN where a motor is let go.
        angles_rad: of both wheels, shape (rows, 2).
        heading_rad: as measured.
        speeds: travel and turning rate from the counts, shape (rows, 2).
        open_v: open-circuit voltage of the battery, shape (rows,).
        floats: 1 where a bridge is open in its off phase, 0 where it shorts its motor, shape (rows, 2).
        shape: radii, track, caster, as `wheel_angles` takes them.
        delay_s: by which the voltages act later than the recordings' stamps say.
    """

    run: IntArray
    time_s: FloatArray
    volts: FloatArray
    angles_rad: FloatArray
    heading_rad: FloatArray
    speeds: FloatArray
    open_v: FloatArray
    floats: FloatArray
    shape: FloatArray
    delay_s: float = 0.0

    def delayed(self, delay_s: float) -> PoweredStack:
        """The runs where all commands act later by a delay; each row has the mean voltage until the next."""
        volts, floats = self.volts.copy(), self.floats.copy()
        for index in range(int(self.run[-1]) + 1):
            rows = np.flatnonzero(self.run == index)
            volts[rows] = _later(self.time_s[rows], self.volts[rows], delay_s)
            before = np.searchsorted(self.time_s[rows], self.time_s[rows] - delay_s, side="right") - 1
            floats[rows] = self.floats[rows][np.maximum(before, 0)]
        return replace(self, volts=volts, floats=floats, delay_s=self.delay_s + delay_s)

    def windows(self, length_s: float) -> IntArray:
        """The window that each row is in; windows of about a length, none across two runs."""
        number, total = np.zeros(self.run.size, dtype=np.int64), 0
        for index in range(int(self.run[-1]) + 1):
            rows = np.flatnonzero(self.run == index)
            time_s = self.time_s[rows] - self.time_s[rows[0]]
            parts = max(1, round(float(time_s[-1]) / length_s))
            number[rows] = total + np.minimum((parts * time_s / time_s[-1]).astype(np.int64), parts - 1)
            total += parts
        return number

    def free_starts(
        self, values: FloatArray, window: IntArray, *, by_values: bool = False
    ) -> tuple[FloatArray, FloatArray]:
        """Counted minus predicted angles since each window began, rad, and their slopes by its starting speeds.

        Returns:
            Shapes (rows, 2) and (rows, 2, 2); with `by_values` the latter is (rows, 2, 28), slopes by `NAMES` behind.
        """
        begins = np.diff(window, prepend=-1) != 0
        told, slopes = wheel_slopes(
            values,
            self.shape,
            self.time_s,
            self.volts,
            self.heading_rad,
            begins,
            self.speeds,
            self.open_v,
            self.floats,
            COLUMNS if by_values else STARTS,
        )
        first = np.maximum.accumulate(np.where(begins, np.arange(begins.size), 0))
        return self.angles_rad - self.angles_rad[first] - told, -slopes


def powered_stack(
    recordings: Sequence[Recording],
    drive: DifferentialDrive,
    geometry: Geometry,
    robot: PoweredRobot,
    slips: Sequence[SlipSpell] = (),
) -> PoweredStack:
    """Runs with their powers, at every row: a command acts whether the camera saw the robot or not.

    A run with spells of slip counts as the parts between them, since a wheel that slips carries no weight along.

    Args:
        recordings: with both power columns.
        drive: names the ports.
        geometry: the fitted wheels and track.
        robot: gives the caster's place, the height of the centre of mass and the battery where a recording has none.
        slips: spells of slip that were located.
    """
    parts = [
        (recording, part)
        for recording in recordings
        for part in gripping(filled_run(recording, drive), slips)
    ]
    runs = [part for _, part in parts]
    volts, time_s, open_v, floats = [], [], [], []
    for index, (recording, run) in enumerate(parts):
        rows = np.searchsorted(recording.time_s, run.time_s)
        duty = np.stack([_duty(recording, port) for port in (drive.left, drive.right)], axis=1)
        supply = _supply(recording, duty, run.time_s, robot.supply_v)
        volts.append(duty[rows] * supply[:, None])
        open_v.append(supply)
        floats.append(
            np.stack([_floats(recording, port)[rows] for port in (drive.left, drive.right)], axis=1)
        )
        time_s.append(run.time_s - run.time_s[0] + _APART_S * index)
    angles = [np.stack([run.left_rad, run.right_rad], axis=1) for run in runs]
    offset = np.radians(geometry.heading_offset_deg)
    radii = np.array([geometry.left_wheel_radius_m, geometry.right_wheel_radius_m])
    rates = [_rates(run.time_s, angle) * radii for run, angle in zip(runs, angles, strict=True)]
    speeds = [
        np.stack([rate.mean(axis=1), (rate[:, 1] - rate[:, 0]) / geometry.track_m], axis=1) for rate in rates
    ]
    return PoweredStack(
        run=np.repeat(np.arange(len(runs)), [run.time_s.size for run in runs]),
        time_s=np.concatenate(time_s),
        volts=np.concatenate(volts),
        angles_rad=np.concatenate(angles),
        heading_rad=np.concatenate([run.pose.heading_rad for run in runs]) - offset,
        speeds=np.concatenate(speeds),
        open_v=np.concatenate(open_v),
        floats=np.concatenate(floats),
        shape=np.array([*radii, geometry.track_m, robot.caster_back_m, robot.height_m, robot.values[_DRAG]]),
    )


def _later(time_s: FloatArray, volts: FloatArray, delay_s: float) -> FloatArray:
    """Mean voltages from each row to the next, of commands that act later; NaN where they mostly let the motor go."""
    free = np.isnan(volts)
    both = np.concatenate([np.where(free, 0.0, volts), free.astype(np.float64)], axis=1)
    span = np.diff(time_s)
    summed = np.concatenate([np.zeros((1, 4)), np.cumsum(both[:-1] * span[:, None], axis=0)])
    edges = time_s - delay_s
    reached = np.stack([np.interp(edges, time_s, column) for column in summed.T], axis=1)
    reached += np.minimum(edges - time_s[0], 0.0)[:, None] * both[0]
    mean = np.diff(reached, axis=0) / span[:, None]
    share = np.concatenate([mean[:, 2:], mean[-1:, 2:]])
    known = np.concatenate([mean[:, :2], mean[-1:, :2]]) / np.maximum(1.0 - share, _HALF)
    return np.where(share > _HALF, np.nan, known)


def _duty(recording: Recording, port: Port) -> FloatArray:
    """Of a port in each row, -1 to 1; NaN where the motor is let go."""
    duty = recording.columns[power_column(port)] / 100.0
    mode = recording.columns.get(mode_column(port))
    if mode is None:
        return duty
    let_go = (mode == DRIVE_MODES.index("coast")) | ((mode == DRIVE_MODES.index("float")) & (duty == 0.0))
    return np.where(let_go, np.nan, duty)


def _floats(recording: Recording, port: Port) -> FloatArray:
    """1 in each row whose bridge is open in its off phase, else 0."""
    mode = recording.columns.get(mode_column(port))
    if mode is None:
        return np.zeros(recording.time_s.size)
    return np.asarray(mode == DRIVE_MODES.index("float"), dtype=np.float64)


def _supply(recording: Recording, duty: FloatArray, time_s: FloatArray, otherwise_v: float) -> FloatArray:
    """The battery's open-circuit voltage, a straight line of time."""
    battery = recording.columns.get(BATTERY)
    known = np.zeros(0, dtype=bool) if battery is None else np.isfinite(battery)
    if battery is None or not known.any():
        return np.full(time_s.size, otherwise_v)
    # A row's reading is taken before its command acts.
    effort = np.nansum(np.abs(np.concatenate([np.zeros((1, 2)), duty[:-1]])), axis=1)
    if np.count_nonzero(known) < _FEWEST_READINGS:
        return np.full(time_s.size, float(np.median(battery[known])))
    level, slope = open_circuit(recording.time_s[known], battery[known], effort[known])
    return np.asarray(level + slope * time_s)


def _rates(time_s: FloatArray, angles: FloatArray) -> FloatArray:
    """Of both wheels, by central differences, rad/s."""
    ahead, behind = (
        np.stack([np.interp(time_s + shift, time_s, angles[:, k]) for k in (0, 1)], axis=1)
        for shift in (_SMOOTH_S, -_SMOOTH_S)
    )
    span = np.minimum(time_s + _SMOOTH_S, time_s[-1]) - np.maximum(time_s - _SMOOTH_S, time_s[0])
    return np.asarray((ahead - behind) / span[:, None])
