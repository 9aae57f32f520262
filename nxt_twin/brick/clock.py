"""The clock that all of this package reads, and the machine's own."""

from __future__ import annotations

import time
from typing import Protocol, final


class Clock(Protocol):
    """A monotonic clock that can wait; tests pass one of their own."""

    def now_s(self) -> float:
        """The time, s, from an arbitrary start; never goes back."""
        ...

    def sleep(self, duration_s: float) -> None:
        """Come back when at least `duration_s` have passed."""
        ...


@final
class SystemClock:
    """The machine's monotonic clock."""

    now_s = staticmethod(time.monotonic)
    """The time, s, since the machine's start or another fixed moment; it is the system's own function, for
    every telegram is stamped twice."""

    def sleep(self, duration_s: float) -> None:
        """Give the processor away for `duration_s`."""
        time.sleep(max(0.0, duration_s))


@final
class PacedClock:
    """Time that passes only when somebody waits for it, and no faster than another clock allows.

    Whoever is slow between two waits loses no time by it: what is done by this clock comes out the same at any speed.

    Args:
        clock: the other.
        speed: how many seconds may pass in one of the other's; infinite to pass at once.
    """

    def __init__(self, clock: Clock, speed: float) -> None:
        self._clock = clock
        self._speed = speed
        self._began_s = clock.now_s()
        self._now_s = 0.0

    def now_s(self) -> float:
        """The time, s, since the clock was made."""
        return self._now_s

    def sleep(self, duration_s: float) -> None:
        """Let time pass, and wait until it may have passed."""
        self._now_s += max(0.0, duration_s)
        ahead_s = self._began_s + self._now_s / self._speed - self._clock.now_s()
        if ahead_s > 0.0:
            self._clock.sleep(ahead_s)
