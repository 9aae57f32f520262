"""A driven motor that does not turn: blocked, or not there."""

from __future__ import annotations

import math
from typing import Literal, final

from nxt_twin.twin.settings import Watch

Trouble = Literal["stall", "disconnected"]

_FREE_PLAY = 2
"""Counts within which a motor that cannot turn may still move: the gear train's play."""

_HARDLY_S = 0.03
"""How long a motor that turns at all takes to leave its free play."""

_MODEL_STANDS_TOO = 4.0
"""Mean square of how far readings are from a model, in their standard deviations, up to which it stands as well."""

_FEWEST = 6
"""Counts that must be alike: a motor that goes to and fro can be read a few times at the same place."""


@final
class Standstill:
    """Watches the counts of one motor.

    A blocked motor had turned before, and gives way a little when it is driven the other way. A motor without
    a cable gives no count in either direction, or has never given any.
    """

    def __init__(self, watch: Watch) -> None:
        self._watch = watch
        self._count: int | None = None
        self._since_s = 0.0
        self._alike = 0
        self._squares = 0.0
        self._ever = False
        self._ways: dict[int, float] = {}
        self._way = 0
        self.trouble: Trouble | None = None

    @property
    def pending(self) -> bool:
        """Whether the motor is driven and has not turned yet: it may be blocked, or about to turn."""
        return self._way != 0

    @property
    def since_s(self) -> float:
        """Since when it has not turned."""
        return self._since_s

    def take(self, time_s: float, count: int, power_pct: int, square: float = math.inf) -> bool:
        """Take a count, the power in force and how far the count is from the model's; True if there is new trouble.

        `trouble` names it. A motor that stands as its model says is none: the model has what blocks it.
        """
        if self._count is None:
            self._begin(time_s, count)
        if abs(count - (self._count or 0)) > _FREE_PLAY:
            self._ever = self._ever or self._count is not None
            self._begin(time_s, count)
        self._alike += 1
        self._squares += square
        way = (power_pct > 0) - (power_pct < 0)
        if abs(power_pct) < self._watch.stall_power_pct:
            way = 0
        if way:
            self._ways.setdefault(way, time_s)
        still_s = time_s - self._since_s
        self._way = way if still_s >= _HARDLY_S else 0
        driven_s = time_s - self._ways[way] if way else 0.0
        if driven_s < self._watch.stall_s or self._alike < _FEWEST:
            return False
        still_at = count == self._count
        gone = still_at and (len(self._ways) == 2 or not self._ever)
        found: Trouble = "disconnected" if gone else "stall"
        if found == "stall" and self._squares < _MODEL_STANDS_TOO * self._alike:
            return False
        new = self.trouble is None or (self.trouble == "stall" and found == "disconnected")
        self.trouble = found if new else self.trouble
        return new

    def _begin(self, time_s: float, count: int) -> None:
        self._count = count
        self._since_s = time_s
        self._alike = 0
        self._squares = 0.0
        self._ways.clear()
        self.trouble = None
