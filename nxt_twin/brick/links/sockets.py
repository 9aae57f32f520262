"""A connected socket as a stream of bytes: what TCP and Bluetooth have in common."""

from __future__ import annotations

import socket
from typing import Final, final

from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError

_WRITE_TIMEOUT_S: Final = 5.0
_READ_SIZE: Final = 4096


@final
class SocketStream:
    """Reads and writes a socket.

    Args:
        connected: the socket, which the stream takes over.
        name: what a person calls the link.
    """

    def __init__(self, connected: socket.socket, name: str) -> None:
        self._socket = connected
        self._name = name
        self._timeout_s = -1.0

    def write(self, data: bytes) -> None:
        """Hand all bytes over; errors as with `ByteStream`."""
        self._set_timeout(_WRITE_TIMEOUT_S)
        try:
            self._socket.sendall(data)
        except TimeoutError as error:
            raise LinkTimeoutError("takes no more bytes", where=self._name) from error
        except OSError as error:
            raise self._lost(error.strerror or str(error)) from error

    def read(self, timeout_s: float) -> bytes:
        """What is there, as soon as anything is; errors as with `ByteStream`."""
        self._set_timeout(timeout_s)
        try:
            data = self._socket.recv(_READ_SIZE)
        except (TimeoutError, BlockingIOError):
            return b""
        except OSError as error:
            raise self._lost(error.strerror or str(error)) from error
        if not data:
            raise self._lost("the other end closed it")
        return data

    def close(self) -> None:
        """Close the socket; what was written is still delivered."""
        self._socket.close()

    def _set_timeout(self, timeout_s: float) -> None:
        if timeout_s != self._timeout_s and self._socket.fileno() >= 0:
            self._socket.settimeout(timeout_s)
            self._timeout_s = timeout_s

    def _lost(self, why: str) -> LinkLostError:
        return LinkLostError(f"the connection is lost: {why}", where=self._name, mend="connect again")
