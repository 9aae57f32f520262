"""Slip at hard starts and stops: tyres hold less than a motor at full power asks of them, for a fifth of a second.

Such slip is too short for the windows of `slip`, and comes at every start. A fit that knows nothing of it takes it for
smaller wheels and a late clock. So it is located before any fit.
It loses far more travel than a wrong radius does, and no shift of the clock accounts for it, as for a late pose's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.slip import SIDES, SlipSpell, WheelTravel, stretches, travel_of
from nxt_twin.physics.robot.drive import Geometry

_HALF_S: Final = 0.04
"""Rates are differences over twice that."""
_SLOWEST_ROWS_S: Final = 0.05  # median time between poses above which no start is located in a run
_HARD_M_S2: Final = 1.5  # gain or loss of a wheel's speed from which slip is looked for
_AFTER_S: Final = 0.35
"""The body goes on gaining speed for so long after the wheel has."""
_RATIO: Final = 0.2  # least share of its speed that a wheel loses at some moment of slip
_LEAST_M_S: Final = 0.03  # least speed that a wheel loses at some moment of slip
_LEAST_LOST_M: Final = 2e-3  # least travel lost at a located start; an unseen start may lose it too
_SIGMAS: Final = 6.0  # standard deviations of noise that the travel lost at a start has to exceed
_MAD: Final = 1.4826  # standard deviation of normal values over their median absolute deviation
_LATE: Final = 0.85
"""The share of the losses from which on they are those of a late clock; of slip that a lag mimics it was up to 0.77."""
_LAGS_S: Final = np.arange(-0.3, 0.3005, 0.005)


@final
@dataclass(frozen=True)
class Unlocated:
    """What slip below the size that is located may do to a fit.

    Attributes:
        geometry: by how much each parameter may be off, in the order of `windows.PARAMETERS`.
        lag_s: by how much a clock may be.
    """

    geometry: FloatArray
    lag_s: float


def hard_starts(runs: Sequence[RobotRun], geometry: Geometry) -> tuple[SlipSpell, ...]:
    """Spells in which wheels that gain or lose speed fast turn without travel, strongest first.

    Args:
        runs: the recordings; of one with fewer than 20 poses a second nothing is said.
        geometry: the robot, roughly; a radius that is a tenth off does no harm.
    """
    found: list[SlipSpell] = []
    for index, run in enumerate(runs):
        if float(np.median(np.diff(run.time_s))) <= _SLOWEST_ROWS_S:
            wheels = [travel_of(index, run, geometry, (run.left_rad, run.right_rad), side) for side in SIDES]
            radii_m = geometry.left_wheel_radius_m, geometry.right_wheel_radius_m
            for wheel, radius_m in zip(wheels, radii_m, strict=True):
                found += _of_wheel(wheel, radius_m)
    return tuple(sorted(found, key=lambda spell: -spell.strength))


def unlocated(runs: Sequence[RobotRun], slips: Sequence[SlipSpell], geometry: Geometry) -> Unlocated | None:
    """By how much slip too small to be located may move a fit; None where no start was located.

    Args:
        runs: the recordings.
        slips: located in them.
        geometry: the robot, roughly.
    """
    starts = sum(spell.lost is not None for spell in slips)
    if not starts:
        return None
    ahead_m, turning_m = (
        sum(float(np.abs(np.diff(_both(run, geometry, sign))).sum()) for run in runs) for sign in (1.0, -1.0)
    )
    moving_s = sum(float(np.diff(run.time_s)[np.diff(run.left_rad) != 0.0].sum()) for run in runs)
    lost_m = _LEAST_LOST_M * starts
    straight, turn = (min(lost_m / max(path_m, 1e-9), 1.0) for path_m in (ahead_m, turning_m))
    sizes = (
        straight * geometry.left_wheel_radius_m,
        straight,
        turn * geometry.track_m,
        _LEAST_LOST_M,
        _LEAST_LOST_M,
        np.degrees(straight),
    )
    return Unlocated(np.array(sizes), _LEAST_LOST_M * 2.0 * moving_s / (ahead_m + turning_m))


def _both(run: RobotRun, geometry: Geometry, sign: float) -> FloatArray:
    """Travels of both wheels together, or of the right against the left, m."""
    return geometry.right_wheel_radius_m * run.right_rad + sign * geometry.left_wheel_radius_m * run.left_rad


def _of_wheel(wheel: WheelTravel, radius_m: float) -> list[SlipSpell]:
    time_s = wheel.time_s
    speed, loss = _rate(time_s, wheel.turned_m), _rate(time_s, wheel.lost_m)
    gain = _rate(time_s, speed)
    near = _about(time_s, np.abs(gain) > _HARD_M_S2)
    if not near.any() or near.all() or _late(wheel, speed, loss, near):
        return []
    noise_m = max(2.0 * _HALF_S * _MAD * float(np.median(np.abs(loss[~near]))), 1e-4)
    slips = np.abs(loss) > np.maximum(_RATIO * np.abs(speed), _LEAST_M_S)
    return [
        _spell(wheel, slice(first, last + 1), radius_m, noise_m)
        for first, last in stretches(near)
        if slips[first : last + 1].any() and _reach(wheel.lost_m[first : last + 1]) > _least(noise_m)
    ]


def _least(noise_m: float) -> float:
    return max(_LEAST_LOST_M, _SIGMAS * noise_m)


def _reach(values: FloatArray) -> float:
    return float(np.ptp(values))


def _late(wheel: WheelTravel, speed: FloatArray, loss: FloatArray, near: BoolArray) -> bool:
    """Whether the body rolls as the wheel turned a moment before or after, as where poses have another clock."""
    rolled, time_s = (speed - loss)[near], wheel.time_s
    left = np.inf
    for lag_s in _LAGS_S:
        then = np.interp(time_s[near] - lag_s, time_s, speed)
        share = float(np.dot(rolled, then)) / max(float(np.dot(then, then)), 1e-12)
        left = min(left, float(np.sum((rolled - share * then) ** 2)))
    return bool(left < (1.0 - _LATE) * float(np.dot(loss[near], loss[near])))


def _spell(wheel: WheelTravel, rows: slice, radius_m: float, noise_m: float) -> SlipSpell:
    time_s, lost_m, turned_m = (part[rows] for part in (wheel.time_s, wheel.lost_m, wheel.turned_m))
    moved_m = max(float(np.abs(np.diff(path)).sum()) for path in (turned_m, turned_m - lost_m))
    reach_m = _reach(lost_m)
    return SlipSpell(
        *wheel.run,
        float(time_s[0]),
        float(time_s[-1]),
        min(reach_m / moved_m, 1.0),
        noise_m / moved_m,
        reach_m / noise_m,
        (time_s, (lost_m - lost_m[0]) / radius_m),
    )


def _about(time_s: FloatArray, flags: BoolArray) -> BoolArray:
    """Rows in which a body still gains speed after a flagged one, and those just before one."""
    latest = np.maximum.accumulate(np.where(flags, time_s, -np.inf))
    coming = np.minimum.accumulate(np.where(flags, time_s, np.inf)[::-1])[::-1]
    return np.asarray((time_s - latest < _AFTER_S) | (coming - time_s < _HALF_S))


def _rate(time_s: FloatArray, values: FloatArray) -> FloatArray:
    ahead, behind = np.minimum(time_s + _HALF_S, time_s[-1]), np.maximum(time_s - _HALF_S, time_s[0])
    return np.asarray(
        (np.interp(ahead, time_s, values) - np.interp(behind, time_s, values)) / (ahead - behind)
    )
