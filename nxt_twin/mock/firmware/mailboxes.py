"""Mailboxes between the host and the program that runs on the brick.

Source: LEGO NXT firmware 1.29, c_cmd.c.
"""

from __future__ import annotations

from collections import deque
from typing import final

from firmware_protocol import limits


@final
class Mailboxes:
    """Twenty queues of messages; a full one drops its oldest."""

    def __init__(self) -> None:
        self._queues: tuple[deque[bytes], ...] = tuple(
            deque(maxlen=limits.MAILBOX_DEPTH) for _ in range(limits.MAILBOX_COUNT)
        )

    def put(self, mailbox: int, message: bytes) -> None:
        """Add a message, its final NUL included."""
        self._queues[mailbox].append(message)

    def oldest(self, mailbox: int) -> bytes | None:
        """The oldest message, left where it is; None if there is none."""
        queue = self._queues[mailbox]
        return queue[0] if queue else None

    def remove(self, mailbox: int) -> None:
        """Remove the oldest message."""
        self._queues[mailbox].popleft()

    def clear(self) -> None:
        """Empty all mailboxes."""
        for queue in self._queues:
            queue.clear()
