"""Clients that come while another one is served: let in if that one leaves at once, told why not otherwise."""

from __future__ import annotations

import socket
from dataclasses import dataclass
from typing import Final, final

from nxt_twin.brick.clock import Clock
from nxt_twin.mock.serve.dialect import Dialect

GRACE_S: Final = 0.5
"""A program that ends and another that begins may cross."""
_SILENT_MOST_S: Final = 5.0
_MOST: Final = 16
_READ_SIZE: Final = 4096


@final
@dataclass(frozen=True)
class _Guest:
    connection: socket.socket
    since_s: float


@final
class Guests:
    """Connections that wait, in the order in which they came.

    Args:
        dialect: how they are told.
        clock: how long they wait.
    """

    def __init__(self, dialect: Dialect, clock: Clock) -> None:
        self._dialect, self._clock = dialect, clock
        self._waiting: list[_Guest] = []

    def add(self, connection: socket.socket) -> None:
        """Take one, unless too many wait already."""
        connection.setblocking(False)  # noqa: FBT003 - the library's interface
        if len(self._waiting) < _MOST:
            self._waiting.append(_Guest(connection, self._clock.now_s()))
        else:
            connection.close()

    def next(self) -> socket.socket | None:
        """The one that has waited longest, to be served."""
        return self._waiting.pop(0).connection if self._waiting else None

    def turn_away(self) -> None:
        """Answer those that have waited for too long, and close their connections."""
        self._waiting = [guest for guest in self._waiting if not self._turned_away(guest)]

    def close(self) -> None:
        """Let all go."""
        for guest in self._waiting:
            guest.connection.close()
        self._waiting.clear()

    def _turned_away(self, guest: _Guest) -> bool:
        waited_s = self._clock.now_s() - guest.since_s
        if waited_s < GRACE_S:
            return False
        try:
            data = guest.connection.recv(_READ_SIZE)
            guest.connection.send(self._dialect.busy(data))
        except BlockingIOError:
            if waited_s < _SILENT_MOST_S:
                return False
        except OSError:
            pass  # it is gone
        guest.connection.close()
        return True
