"""A connected socket as a stream of bytes: what TCP and Bluetooth have in common."""

from __future__ import annotations

import select
import socket
from collections.abc import Callable
from typing import Final, final

from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError

_WRITE_TIMEOUT_S: Final = 5.0
_READ_SIZE: Final = 4096


@final
class SocketStream:
    """Reads and writes a socket.

    A socket with a timeout asks the system at each use whether it is ready. Different timeouts for reads and writes
    cost a further call each time. This one never waits by itself: a write is a single call, a read two.

    Args:
        connected: the socket, which the stream takes over.
        name: what a person calls the link.
    """

    def __init__(self, connected: socket.socket, name: str) -> None:
        connected.settimeout(0.0)
        self._socket = connected
        self._name = name
        self._send, self._receive = connected.send, connected.recv
        self._wait_to_read = _waiting(connected, to_write=False)
        self._wait_to_write = _waiting(connected, to_write=True)

    def write(self, data: bytes) -> None:
        """Hand all bytes over; errors as with `ByteStream`."""
        try:
            while (sent := self._send_some(data)) < len(data):
                data = data[sent:]
                if not self._wait_to_write(_WRITE_TIMEOUT_S):
                    raise LinkTimeoutError("takes no more bytes", where=self._name)
        except (OSError, ValueError) as error:
            raise self._lost(error) from error

    def read(self, timeout_s: float) -> bytes:
        """The bytes that have arrived, once there are any; errors as with `ByteStream`."""
        try:
            if not self._wait_to_read(timeout_s):
                return b""
            data = self._receive(_READ_SIZE)
        except BlockingIOError:
            return b""
        except (OSError, ValueError) as error:
            raise self._lost(error) from error
        if not data:
            raise self._lost("the other end closed it")
        return data

    def close(self) -> None:
        """Close the socket; what was written is still delivered."""
        self._socket.close()

    def _send_some(self, data: bytes) -> int:
        try:
            return self._send(data)
        except BlockingIOError:
            return 0

    def _lost(self, why: OSError | ValueError | str) -> LinkLostError:
        text = getattr(why, "strerror", None) or str(why)
        return LinkLostError(f"the connection is lost: {text}", where=self._name, mend="connect again")


def _waiting(connected: socket.socket, *, to_write: bool) -> Callable[[float], object]:
    """What waits for at most that many seconds, and gives something true if the socket is ready (or broken)."""
    if not hasattr(select, "poll"):  # Windows
        return lambda timeout_s: any(
            select.select(*(([], [connected]) if to_write else ([connected], [])), [connected], timeout_s)
        )
    poll = select.poll()
    poll.register(connected, select.POLLOUT if to_write else select.POLLIN)
    return lambda timeout_s: poll.poll(timeout_s * 1000)
