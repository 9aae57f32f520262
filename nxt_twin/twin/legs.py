"""The squares that a robot on two wheels drives while it is watched beside its ghost."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from itertools import accumulate
from typing import Final, final

from nxt_twin.recording.columns import Port
from nxt_twin.twin.driver import Told

_AHEAD: Final = (2.0, 35, 35)
_LEFT: Final = (0.9, -30, 30)
_RIGHT: Final = (0.9, 30, -30)
_REST: Final = (0.3, 0, 0)
_SIDE: Final = (_AHEAD, _REST)
LEGS: Final = (*(4 * (*_SIDE, _LEFT, _REST)), *(4 * (*_SIDE, _RIGHT, _REST)))
"""Duration (s) and power (%) of the left and the right wheel: a square one way round, then one the other way.

Tyres hold at these powers, so that the counts tell the path. Both ways round, wheels and track show apart."""


@final
class LegsDriver:
    """Drives `LEGS` over and over.

    Args:
        left: the port of the left wheel.
        right: that of the right wheel.
    """

    def __init__(self, left: Port, right: Port) -> None:
        self._wheels = left, right
        self._ends_s = list(accumulate(leg[0] for leg in LEGS))

    @property
    def ports(self) -> tuple[Port, ...]:
        """Both wheels."""
        return self._wheels

    def at(self, time_s: float, counts: Mapping[Port, int]) -> Mapping[Port, Told]:
        """What should be in force now; what the encoders say plays no part."""
        del counts
        leg = LEGS[min(bisect_right(self._ends_s, time_s % self._ends_s[-1]), len(LEGS) - 1)]
        return {port: (power, "drive") for port, power in zip(self._wheels, leg[1:], strict=True)}
