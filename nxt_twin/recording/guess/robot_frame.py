"""Units and signs that a robot's columns tell: course against heading, wheels against travel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians, tau
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray

UNITS_RAD: Final = {"deg": radians(1.0), "rad": 1.0, "turn": tau}
_LEG: Final = 0.03  # of the place's span, which is a leg long enough to have a course
_FEWEST_LEGS: Final = 8
_CLEAR: Final = 0.05  # by which a resultant has to be longer
_ALIKE: Final = 0.8
_TURNING_RAD: Final = 0.1


@final
@dataclass(frozen=True)
class RobotFrame:
    """How a robot's columns go together.

    Attributes:
        unit: of the heading.
        turns: 1 where the heading grows counter-clockwise in the plane of x and y as they are given, else -1.
        is_clear: whether the recording tells unit and turning sense at all.
        mirrored: whether pose and wheels turn opposite ways: y points to the right, or the wheels are interchanged.
        left: 1 where the left column grows as the robot drives on, -1 where the right one grows and it falls.
        right: likewise.
        step: travel for each of the wheels' counts, in the unit of the place.
    """

    unit: str
    turns: float
    is_clear: bool
    mirrored: bool
    left: float
    right: float
    step: float


@final
@dataclass(frozen=True)
class _Legs:
    """Short pieces of the path: lengths, courses and the rows at both ends."""

    length: FloatArray
    course: FloatArray
    first: list[int]
    last: list[int]


def frame_of(
    place: tuple[FloatArray, FloatArray], heading: FloatArray, wheels: tuple[FloatArray, FloatArray],
    units: Sequence[str],
) -> RobotFrame | None:  # fmt: skip
    """The frame in which place, heading and wheels fit one another best; None where the robot hardly travels.

    Args:
        place: x and y, in one unit.
        heading: in a unit that is one of `units`.
        wheels: left and right, in counts of equal size.
        units: of the heading, the likeliest first.
    """
    known = np.all(np.isfinite([*place, heading, *wheels]), axis=0)
    x, y, angle, left, right = (each[known] for each in (*place, heading, *wheels))
    legs = _legs(x, y)
    if len(legs.first) < _FEWEST_LEGS:
        return None
    found = {(unit, turns): _resultant(legs, angle, unit, turns) for unit in units for turns in (1.0, -1.0)}
    usual = (units[0], 1.0)
    best = max(found, key=lambda each: abs(found[each]))
    if abs(found[best]) < abs(found[usual]) + _CLEAR:
        best = usual
    others = [abs(each) for key, each in found.items() if key != best]
    is_clear = abs(found[best]) > _ALIKE and abs(found[best]) > max(others, default=0.0) + _CLEAR
    unit, turns = best
    turned = _turned(angle, unit, turns)
    middle, weight = _heading_of_legs(legs, turned)
    ahead = weight * legs.length * np.cos(legs.course - middle - 0.5 * np.angle(found[best]))
    moved = weight * np.array([left[legs.last] - left[legs.first], right[legs.last] - right[legs.first]])
    by_left, by_right = np.linalg.lstsq(moved.T, ahead, rcond=None)[0]
    signs = (-1.0 if by_left < 0.0 < by_right else 1.0, -1.0 if by_right < 0.0 < by_left else 1.0)
    wheels_turn = np.diff(signs[1] * right - signs[0] * left)
    mirrored = bool(float(np.diff(turned) @ wheels_turn) < 0.0)
    step = float(abs(by_left) + abs(by_right))
    return RobotFrame(unit, turns, is_clear, mirrored, signs[0], signs[1], step)


def _legs(x: FloatArray, y: FloatArray) -> _Legs:
    """The path cut where the place has moved by a leg's length."""
    shortest = _LEG * float(np.hypot(np.ptp(x), np.ptp(y)))
    first, last, start = [], [], 0
    for row in range(1, x.size):
        if shortest > 0.0 and np.hypot(x[row] - x[start], y[row] - y[start]) >= shortest:
            first.append(start)
            last.append(row)
            start = row
    dx, dy = x[last] - x[first], y[last] - y[first]
    return _Legs(np.hypot(dx, dy), np.arctan2(dy, dx), first, last)


def _turned(heading: FloatArray, unit: str, turns: float) -> FloatArray:
    """The heading unwrapped, rad."""
    return np.asarray(turns * np.unwrap(heading, period=tau / UNITS_RAD[unit]) * UNITS_RAD[unit])


def _heading_of_legs(legs: _Legs, turned: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The mean heading of each leg, and its weight: little where the robot turns."""
    parts = [turned[a : b + 1] for a, b in zip(legs.first, legs.last, strict=True)]
    turning = np.array([np.ptp(part) for part in parts])
    return np.array([part.mean() for part in parts]), legs.length / (1.0 + (turning / _TURNING_RAD) ** 2)


def _resultant(legs: _Legs, heading: FloatArray, unit: str, turns: float) -> complex:
    """How well the course keeps one angle to the heading, forward or backward: 1 in size where it does throughout."""
    middle, weight = _heading_of_legs(legs, _turned(heading, unit, turns))
    return complex(np.sum(weight * np.exp(2j * (legs.course - middle))) / np.sum(weight))
