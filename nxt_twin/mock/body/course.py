"""A value over time: constant until it is set anew, or on a course given in advance."""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from typing import Literal, Protocol, final

Between = Literal["step", "line"]


class SensorView(Protocol):
    """The view of a sensor: a course, or a test rig round the brick."""

    def at(self, time_s: float) -> float:
        """The value at a time since power-on."""
        ...


@final
class TargetCourse:
    """The view of a sensor over time.

    Args:
        points: (time s, value), in order of time; before the first point its value holds, after the last its.
        between: hold each value until the next point, or go there in a straight line.
        repeat: start over at the last point's time.
    """

    def __init__(
        self, points: Sequence[tuple[float, float]], *, between: Between = "step", repeat: bool = False
    ) -> None:
        self._times = [time_s for time_s, _ in points]
        self._values = [value for _, value in points]
        self._between = between
        self._repeat = repeat

    def set(self, value: float) -> None:
        """Show this from now on."""
        self._times, self._values = [0.0], [value]

    def at(self, time_s: float) -> float:
        """The value at a time since power-on."""
        if len(self._values) == 1:
            return self._values[0]
        if self._repeat and self._times[-1] > 0.0:
            time_s %= self._times[-1]
        after = bisect.bisect_right(self._times, time_s)
        if after == 0 or after == len(self._times):
            return self._values[max(0, after - 1)]
        before = after - 1
        if self._between == "step":
            return self._values[before]
        span_s = self._times[after] - self._times[before]
        share = (time_s - self._times[before]) / span_s
        return self._values[before] + share * (self._values[after] - self._values[before])


def constant(value: float) -> TargetCourse:
    """A course that stays at `value`."""
    return TargetCourse([(0.0, value)])
