"""A clock that a test turns, and a link that says what a test wrote down."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError


class VirtualClock:
    """Time passes when something sleeps or waits, and by a microsecond at each look."""

    def __init__(self) -> None:
        self.time_s = 100.0

    def now_s(self) -> float:
        self.time_s += 1e-6
        return self.time_s

    def sleep(self, duration_s: float) -> None:
        self.time_s += max(0.0, duration_s)


class ScriptedLink:
    """Gives, after each telegram sent, what the script says: replies, or errors to raise.

    Args:
        clock: passes when nothing comes.
        script: from a telegram to what comes then; each item is bytes, an error, or a delay in s.
    """

    def __init__(
        self, clock: VirtualClock, script: Callable[[bytes], list[bytes | BaseException | float]]
    ) -> None:
        self._clock = clock
        self._script = script
        self._coming: deque[bytes | BaseException | float] = deque()
        self.sent: list[bytes] = []
        self.closed = 0

    def send(self, telegram: bytes) -> None:
        if self.closed:
            raise LinkLostError("closed")
        self.sent.append(telegram)
        self._coming.extend(self._script(telegram))

    def receive(self, timeout_s: float) -> bytes:
        left_s = timeout_s
        while self._coming:
            coming = self._coming[0]
            if isinstance(coming, float):
                if coming > left_s:
                    self._coming[0] = coming - left_s
                    break
                self._clock.sleep(coming)
                left_s -= coming
                self._coming.popleft()
                continue
            self._coming.popleft()
            if isinstance(coming, BaseException):
                raise coming
            return coming
        self._clock.sleep(left_s)
        raise LinkTimeoutError("nothing came")

    def close(self) -> None:
        self.closed += 1

    def describe(self) -> str:
        return "script"


def marker_reply(telegram: bytes) -> bytes:
    """The reply to an IOMAP_READ, as long as asked for."""
    length = int.from_bytes(telegram[8:10], "little")
    return b"\x02\x94\x00" + telegram[2:6] + telegram[8:10] + bytes(length)
