"""The shapes that something missing may have, by the equation that it would be missing from.

No effect of the library takes part. A shape is a family of functions of speed, angle, time or command. Any
sum of them may be missing; its only parameters are the sizes of its parts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numba import njit

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.where.course import Course
from nxt_twin.diagnose.where.response import Entry
from nxt_twin.diagnose.where.second_body import behind_play, by_rubbing, on_a_spring
from nxt_twin.physics.effect import Equation

_SPEEDS = (0.03, 0.1, 0.25, 0.45, 0.7, 1.0, 1.4, 2.0, 3.0)
_DRIVES = (0.0, 0.03, 0.15, 0.4, 0.8, 1.5, 2.5, 4.0)
_COMMANDS = tuple(np.linspace(0.0, 1.0, 9))
_CYCLES = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 24)
_FEW_CYCLES = (1, 2, 3)
_ENCODER_CYCLES = (1, 2, 3, 4)
_PLACES = 12  # knots over the reach, evenly spaced
_END_DEG = 4.0  # deg: length of the stretch at either end of the reach
_SLIDING_SHARE = 0.02  # of the root mean square speed: width over which friction changes its sign
_SLOW_SHARE = 0.33  # of the root mean square speed, at which the unknown torque's variance has halved
_SINCE_REVERSAL_DEG = (1.0, 3.0, 8.0, 20.0)
_REMEMBERING_S = (0.3, 1.0, 4.0)
_HEATING_S = (1.0, 4.0, 20.0)
_FREQUENCIES_HZ = tuple(np.geomspace(2.0, 15.0, 14))
_RESONANCE_DAMPING = 0.08  # damping ratio of a second body on a spring
_GAPS_DEG = (1.5, 2.5, 4.0, 6.0, 9.0, 14.0)
_DRAGS_AND_REBOUNDS = ((0.1, 0.0), (0.1, 0.4), (5.0, 0.0))
_GRIPS = (2.0, 5.0, 15.0)
_SLOW_S, _QUICK_S = 2.0, 0.65
_MOST_PARTS = 48  # knots over time at most
_FEWEST_PARTS = 8  # knots over time that `_MOST_CELLS` leaves at least
_MOST_CELLS = 4_000_000  # parts times samples, which bounds the memory of an hour's recording


@final
@dataclass(frozen=True)
class Yardstick:
    """Ordinary sizes in these recordings.

    Attributes:
        speed, acceleration, drive: root mean square.
        command: the largest.
        places: knots over where the plant has been, shape (knots,).
        ends: knots about the ends of that, shape (knots,).
        slow_s, quick_s: knots over all recordings laid end to end, shape (knots,).
    """

    speed: float
    acceleration: float
    drive: float
    command: float
    places: FloatArray
    ends: FloatArray
    slow_s: FloatArray
    quick_s: FloatArray


@final
@dataclass(frozen=True)
class ShapeFamily:
    """One family of functions.

    Attributes:
        equation: the one that they would be missing from.
        entry: where they come in.
        rows: their values, shape (functions, samples); only their sizes beside one another matter.
    """

    equation: Equation
    entry: Entry
    rows: Callable[[Course, Yardstick], FloatArray]


@final
@dataclass(frozen=True)
class Restless:
    """A noise whose size goes with what the plant does.

    Attributes:
        equation: the one in which it is.
        entry: where it comes in.
        weights: its variance but for a factor, shape (samples,).
    """

    equation: Equation
    entry: Entry
    weights: Callable[[Course, Yardstick], FloatArray]


def yardstick(courses: Sequence[Course]) -> Yardstick:
    """Measure `courses`."""
    position = np.concatenate([course.position for course in courses])
    samples = position.size
    most = int(np.clip(_MOST_CELLS // samples, _FEWEST_PARTS, _MOST_PARTS))
    ends_s = max(float(course.laid_s[-1]) for course in courses)

    def knots_s(spacing_s: float) -> FloatArray:
        return np.linspace(0.0, ends_s, int(np.clip(ends_s / spacing_s, 2, most)))

    return Yardstick(
        speed=_rms([course.speed for course in courses]),
        acceleration=_rms([course.acceleration for course in courses]),
        drive=_rms([course.drive for course in courses]),
        command=max(max(float(np.abs(course.command).max()) for course in courses), 1e-12),
        ends=_ends(position),
        places=np.linspace(position.min(), position.max() + 1e-9, _PLACES),
        slow_s=knots_s(_SLOW_S),
        quick_s=knots_s(_QUICK_S),
    )


def hats(values: FloatArray, knots: Sequence[float] | FloatArray) -> FloatArray:
    """The hat functions on `knots` at `values`, shape (knots, values); the outer ones go on for ever."""
    places = np.asarray(knots, dtype=np.float64)
    inside = np.clip(values, places[0], places[-1])
    left = np.clip(np.searchsorted(places, inside, side="right") - 1, 0, places.size - 2)
    share = (inside - places[left]) / (places[left + 1] - places[left])
    found = np.zeros((places.size, values.size))
    samples = np.arange(values.size)
    found[left, samples] = 1.0 - share
    found[left + 1, samples] = share
    return found


def _rms(arrays: Sequence[FloatArray]) -> float:
    return max(float(np.sqrt(np.mean(np.concatenate(arrays) ** 2))), 1e-12)


def _ends(position: FloatArray) -> FloatArray:
    low, high = position.min(), position.max() + 1e-9
    margin = min(np.deg2rad(_END_DEG), 0.25 * (high - low))
    return np.array([low, low + margin, high - margin, high])


def _waves(angle: FloatArray, cycles: Sequence[int]) -> FloatArray:
    return np.array([wave(n * angle) for n in cycles for wave in (np.sin, np.cos)])


def _sliding(course: Course, unit: Yardstick) -> FloatArray:
    return np.asarray(np.tanh(course.pace / (_SLIDING_SHARE * unit.speed)))


def _of_speed(values: FloatArray, unit: Yardstick) -> FloatArray:
    return hats(values / unit.speed, [*(-knot for knot in reversed(_SPEEDS)), *_SPEEDS])


def _of_size(values: FloatArray, knots: Sequence[float]) -> FloatArray:
    """Odd functions: electronics treat both directions alike."""
    return hats(np.abs(values), knots) * np.sign(values)


def _friction(course: Course, unit: Yardstick) -> FloatArray:
    return _of_speed(course.pace, unit)


def _plain_friction(course: Course, unit: Yardstick) -> FloatArray:
    pace = course.pace / unit.speed
    return np.array([np.ones(pace.size), _sliding(course, unit), pace, pace * np.abs(pace)])


def _friction_that_remembers(course: Course, unit: Yardstick) -> FloatArray:
    motion = (course.speed / unit.speed, course.acceleration / unit.acceleration)
    kept = np.array([_kept(course.time_s, np.abs(one), s) for one in motion for s in _REMEMBERING_S])
    return np.concatenate([kept * _sliding(course, unit), kept * course.pace / unit.speed])


def _around_a_turn(course: Course, unit: Yardstick) -> FloatArray:
    del unit
    return _waves(course.passed, _CYCLES)


def _over_the_reach(course: Course, unit: Yardstick) -> FloatArray:
    return hats(course.passed, unit.places)


def _held_at_the_ends(course: Course, unit: Yardstick) -> FloatArray:
    return hats(course.passed, unit.ends) * course.drive / unit.drive


def _friction_around_a_turn(course: Course, unit: Yardstick) -> FloatArray:
    """Also such as catches one way only."""
    waves = _waves(course.passed, _FEW_CYCLES)
    return np.concatenate([waves, waves * _sliding(course, unit)])


def _drag_around_a_turn(course: Course, unit: Yardstick) -> FloatArray:
    return _waves(course.passed, _FEW_CYCLES) * course.pace / unit.speed


def _load_in_time(course: Course, unit: Yardstick) -> FloatArray:
    return hats(course.laid_s, unit.quick_s)


def _friction_in_time(course: Course, unit: Yardstick) -> FloatArray:
    return hats(course.laid_s, unit.slow_s) * _sliding(course, unit)


def _inertia_in_time(course: Course, unit: Yardstick) -> FloatArray:
    return hats(course.laid_s, unit.slow_s) * course.acceleration


def _friction_by_load(course: Course, unit: Yardstick) -> FloatArray:
    load = np.abs(course.drive) / unit.drive
    return np.array([load, load**2]) * _sliding(course, unit)


def _after_reversal(course: Course, unit: Yardstick) -> FloatArray:
    turned = np.flatnonzero(np.diff(np.sign(course.speed)) != 0.0) + 1
    last = np.zeros(course.speed.size, dtype=np.int64)
    last[turned] = turned
    since = np.abs(course.position - course.position[np.maximum.accumulate(last)])
    fading = np.exp(-since / np.deg2rad(_SINCE_REVERSAL_DEG)[:, None])
    return fading * _sliding(course, unit)


def _power_curve(course: Course, unit: Yardstick) -> FloatArray:
    driven = course.drive != 0.0
    return np.asarray(_of_size(course.command / unit.command, _COMMANDS) * driven)


def _current_curve(course: Course, unit: Yardstick) -> FloatArray:
    return _of_size(course.drive / unit.drive, _DRIVES)


def _supply_under_load(course: Course, unit: Yardstick) -> FloatArray:
    duty, current = course.command / unit.command, course.drive / unit.drive
    return np.array([np.abs(duty) * current, duty**2 * current, np.abs(current) * duty])


def _supply_in_time(course: Course, unit: Yardstick) -> FloatArray:
    duty = course.command / unit.command * (course.drive != 0.0)
    return np.asarray(hats(course.laid_s, unit.slow_s) * duty)


def _heat(course: Course, unit: Yardstick) -> FloatArray:
    current, duty = course.drive / unit.drive, course.command / unit.command
    heat = np.array([_kept(course.time_s, current**2, keeping_s) for keeping_s in _HEATING_S])
    return np.concatenate([heat * current, heat * duty])


def _current_around_a_turn(course: Course, unit: Yardstick) -> FloatArray:
    waves, current = _waves(course.passed, _FEW_CYCLES), course.drive / unit.drive
    return np.concatenate([waves * current, waves * np.abs(current)])


def _on_springs(course: Course, unit: Yardstick) -> FloatArray:
    del unit
    return np.concatenate(
        [on_a_spring(course.time_s, course.position, f, _RESONANCE_DAMPING) for f in _FREQUENCIES_HZ]
    )


def _behind_plays(course: Course, unit: Yardstick) -> FloatArray:
    del unit
    return np.array(
        [
            behind_play(course.time_s, course.position, course.speed, gap, drag_per_s, rebound)
            for gap in np.deg2rad(_GAPS_DEG)
            for drag_per_s, rebound in _DRAGS_AND_REBOUNDS
        ]
    )


def _by_rubbings(course: Course, unit: Yardstick) -> FloatArray:
    del unit
    return np.array([by_rubbing(course.time_s, course.speed, grip) for grip in _GRIPS])


def _counts_by_speed(course: Course, unit: Yardstick) -> FloatArray:
    return _of_speed(course.pace, unit)


def _encoder_around_a_turn(course: Course, unit: Yardstick) -> FloatArray:
    del unit
    return _waves(course.position, _ENCODER_CYCLES)


def _counts_in_time(course: Course, unit: Yardstick) -> FloatArray:
    return hats(course.laid_s, unit.quick_s) * course.pace


SHAPES: tuple[ShapeFamily, ...] = (
    ShapeFamily("torque_balance", "torque", _plain_friction),
    ShapeFamily("torque_balance", "torque", _friction),
    ShapeFamily("torque_balance", "torque", _friction_that_remembers),
    ShapeFamily("torque_balance", "torque", _around_a_turn),
    ShapeFamily("torque_balance", "torque", _over_the_reach),
    ShapeFamily("torque_balance", "torque", _held_at_the_ends),
    ShapeFamily("torque_balance", "torque", _friction_around_a_turn),
    ShapeFamily("torque_balance", "torque", _drag_around_a_turn),
    ShapeFamily("torque_balance", "torque", _load_in_time),
    ShapeFamily("torque_balance", "torque", _friction_in_time),
    ShapeFamily("torque_balance", "torque", _inertia_in_time),
    ShapeFamily("torque_balance", "torque", _friction_by_load),
    ShapeFamily("torque_balance", "torque", _after_reversal),
    ShapeFamily("electrical", "torque", _power_curve),
    ShapeFamily("electrical", "torque", _current_curve),
    ShapeFamily("electrical", "torque", _supply_under_load),
    ShapeFamily("electrical", "torque", _supply_in_time),
    ShapeFamily("electrical", "torque", _heat),
    ShapeFamily("electrical", "torque", _current_around_a_turn),
    ShapeFamily("kinematic", "torque", _on_springs),
    ShapeFamily("kinematic", "torque", _behind_plays),
    ShapeFamily("kinematic", "torque", _by_rubbings),
    ShapeFamily("measurement", "count", _counts_by_speed),
    ShapeFamily("measurement", "count", _counts_in_time),
    ShapeFamily("measurement", "reading", _encoder_around_a_turn),
)

LAWS: tuple[ShapeFamily, ...] = tuple(
    shape for shape in SHAPES if shape.equation != "kinematic" and shape.rows is not _inertia_in_time
)
"""Those but for a second body and an inertia that changes: right effects leave errors that look like these."""


RESTLESS: tuple[Restless, ...] = (
    Restless(
        "torque_balance",
        "torque",
        lambda course, unit: 1.0 / (1.0 + (course.speed / (_SLOW_SHARE * unit.speed)) ** 2),
    ),
    Restless("measurement", "count", lambda course, unit: np.abs(course.speed) / unit.speed),
    Restless("timing", "reading", lambda course, unit: (course.speed / unit.speed) ** 2),
)


@njit(cache=True, nogil=True)
def _kept(time_s, values, keeping_s):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """A leaky average of `values` over `keeping_s`."""
    found = np.zeros(values.shape[0])
    for k in range(1, values.shape[0]):
        share = 1.0 - np.exp(-(time_s[k] - time_s[k - 1]) / keeping_s)
        found[k] = found[k - 1] + share * (values[k] - found[k - 1])
    return found
