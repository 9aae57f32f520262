"""A clock that jumps, to pace a mock in tests; otherwise the machine's is passed in."""

from __future__ import annotations

from typing import final


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
