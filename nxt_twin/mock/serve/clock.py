"""The clock that paces the mock: the machine's, passed in, or one that jumps."""

from __future__ import annotations

from typing import Protocol, final


class Clock(Protocol):
    """A monotonic clock that can wait."""

    def now_s(self) -> float:
        """The time, s, from an arbitrary start."""
        ...

    def sleep(self, duration_s: float) -> None:
        """Come back when `duration_s` have passed."""
        ...


@final
class VirtualClock:
    """Time that passes only when somebody waits for it, and then at once."""

    def __init__(self) -> None:
        self._now_s = 0.0

    def now_s(self) -> float:
        """The time, s."""
        return self._now_s

    def sleep(self, duration_s: float) -> None:
        """Let time pass."""
        self._now_s += max(0.0, duration_s)
