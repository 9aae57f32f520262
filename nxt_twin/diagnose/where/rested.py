"""Friction that goes with the time at rest, as no effect of the library does."""

from __future__ import annotations

import numpy as np
from numba import njit

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.where.course import Course
from nxt_twin.diagnose.where.shapes import ShapeFamily, Yardstick, hats

_SLOW_SHARE = 0.03  # of the root mean square speed, below which the plant is slow
_RESTS_S = (0.03, 0.1, 0.3, 1.0, 3.0)
_SHORTEST_S = 1e-3  # s added to the time at rest, so that its logarithm is finite
_SLIDING_ON_DEG = (2.0, 8.0)
_FORGETTING_DEG = 8.0  # deg of motion that leave 1/e of an earlier time at rest


def _holding(course: Course, unit: Yardstick) -> FloatArray:
    """A friction that has grown while the plant is slow, against the drive."""
    slow, rested_s, _ = _rests(course, unit)
    return _by_rest(rested_s) * slow * np.sign(course.drive)


def _sliding_on(course: Course, unit: Yardstick) -> FloatArray:
    """A friction that has grown at rest, and fades with the motion since."""
    slow, rested_s, since = _rests(course, unit)
    against = np.where(slow, np.sign(course.drive), np.sign(course.pace))
    fading = [np.exp(-since / np.deg2rad(far)) for far in _SLIDING_ON_DEG]
    return np.concatenate([_by_rest(rested_s) * fade * against for fade in fading])


def _by_rest(rested_s: FloatArray) -> FloatArray:
    return hats(np.log(rested_s + _SHORTEST_S), np.log(_RESTS_S))


def _rests(course: Course, unit: Yardstick) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Whether the plant is slow, for how long it was at last, s, and how far it has come since, rad or m."""
    slow = np.abs(course.pace) < _SLOW_SHARE * unit.speed
    rested_s, since = _rest_and_way(course.time_s, course.position, slow, np.deg2rad(_FORGETTING_DEG))
    return slow.astype(np.float64), rested_s, since


RESTED: tuple[ShapeFamily, ...] = (
    ShapeFamily("torque_balance", "torque", _holding),
    ShapeFamily("torque_balance", "torque", _sliding_on),
)


@njit(cache=True, nogil=True)
def _rest_and_way(time_s, position, slow, forgetting):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """Of each sample; a short rest after a short way goes on from the rest before."""
    rested_s, since = np.zeros(time_s.shape[0]), np.zeros(time_s.shape[0])
    resting_s = 0.0
    for k in range(1, time_s.shape[0]):
        if slow[k]:
            resting_s += time_s[k] - time_s[k - 1]
            rested_s[k] = max(resting_s, rested_s[k - 1] * np.exp(-since[k - 1] / forgetting))
        else:
            resting_s = 0.0
            rested_s[k] = rested_s[k - 1]
            since[k] = since[k - 1] + abs(position[k] - position[k - 1])
    return rested_s, since
