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
