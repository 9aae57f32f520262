"""Stamps that were rounded to a coarse step: when their rows were read."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.clump_course import walk_smoothed

_RESOLUTION_S: Final = 1e-6  # of stamps in files: no step is told to less
_LEAST_STEP_S: Final = 5e-4  # a finer one moves no reading by what matters
_COARSE: Final = 0.15  # of the usual time from row to row: a finer step tells that time well enough
_FEWEST_ROWS: Final = 64
_UNEVEN: Final = (
    0.03  # share of the intervals that are not the commonest one: an even timer's are, rounded or not
)
_OF_ONE_STEP: Final = (
    0.1  # that share where the commonest is one step: an even timer that drops rows leaves some, too
)
_FAR: Final = 16  # rows over which the walk of the polls is told from the rounding
_STALLED: Final = 3.0  # steps beyond the usual interval from which a host stood still
_EVEN: Final = 0.01  # of the interval: no polls are taken for more even than that


@final
@dataclass(frozen=True)
class RoundedCourse:
    """When rows were read, and how far that is open, a standard deviation, s, shape (rows,)."""

    time_s: FloatArray
    open_s: FloatArray


def rounding_s(time_s: FloatArray) -> float:
    """The step to which stamps were rounded, s; 0 where they are fine, or too few, or as even as a timer's."""
    apart = np.round(np.diff(time_s) / _RESOLUTION_S).astype(np.int64)
    if apart.size < _FEWEST_ROWS or apart.min() < 0:
        return 0.0
    step_s = float(np.gcd.reduce(apart)) * _RESOLUTION_S
    commonest = int(np.median(apart))
    commonest_s = commonest * _RESOLUTION_S
    least = _OF_ONE_STEP if step_s > 0.9 * commonest_s else _UNEVEN
    uneven = np.mean(apart != commonest) > least
    return step_s if uneven and step_s >= max(_COARSE * commonest_s, _LEAST_STEP_S) else 0.0


def course_through(time_s: FloatArray, step_s: float) -> RoundedCourse:
    """An even course through stamps that were rounded to `step_s`.

    The time from one row to the next is a random walk about the usual one, and a stamp is off by the rounding. The mean
    of that is left in: it moves readings and commands alike.
    """
    apart_s = np.diff(time_s)
    usual_s = float(np.median(apart_s))
    stalled = apart_s > usual_s + _STALLED * max(step_s, 0.5 * usual_s)
    usual_s = float(np.mean(apart_s[~stalled]))
    off_s = np.where(stalled, 0.0, apart_s - usual_s)
    noise_s2 = step_s**2 / 12.0
    walk_s2 = max(_walk_s2(off_s, noise_s2), (_EVEN * usual_s) ** 2)
    steps_s = np.where(stalled, apart_s, usual_s)
    walks_s2 = np.where(stalled, usual_s**2, walk_s2)
    read_s, open_s2 = walk_smoothed(time_s, steps_s, walks_s2, noise_s2)
    within_s = np.clip(read_s, time_s - step_s, time_s + step_s)
    return RoundedCourse(np.maximum.accumulate(within_s), np.sqrt(open_s2))


def _walk_s2(off_s: FloatArray, noise_s2: float) -> float:
    """The variance of the time from one row to the next, s², without that of the rounding."""
    far = min(_FAR, off_s.size // 4)
    course_s = np.append(0.0, np.cumsum(off_s))
    far_s2 = float(np.mean((course_s[far:] - course_s[:-far]) ** 2))
    near_s2 = float(np.mean(off_s**2))
    apart = max(0.0, far_s2 - 2.0 * noise_s2) / far
    return min(apart, max(near_s2 - 2.0 * noise_s2, 0.0)) if math.isfinite(apart) else 0.0
