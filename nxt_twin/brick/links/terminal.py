"""An open terminal as a stream of bytes, by the system's own calls: several times quicker than pyserial's."""

from __future__ import annotations

import os
import select
from typing import Final, final

import serial

from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError

_WRITE_TIMEOUT_MS: Final = 5000
_READ_SIZE: Final = 4096


@final
class TerminalStream:
    """Reads and writes a serial port where ports are files (not on Windows).

    Args:
        port: the open port, which pyserial has set up and locked, and which the stream takes over.
        name: what a person calls the link.
    """

    def __init__(self, port: serial.Serial, name: str) -> None:
        self._port = port
        self._name = name
        self._handle: int = port.fileno()
        self._readable = select.poll()
        self._readable.register(self._handle, select.POLLIN)
        self._writable = select.poll()
        self._writable.register(self._handle, select.POLLOUT)

    def write(self, data: bytes) -> None:
        """Hand all bytes over; errors as with `ByteStream`."""
        left = data
        while left:
            try:
                left = left[os.write(self._handle, left) :]
            except BlockingIOError:
                self._wait_until_writable()
            except OSError as error:
                raise self._lost(error.strerror) from error

    def read(self, timeout_s: float) -> bytes:
        """What is there, as soon as anything is; errors as with `ByteStream`."""
        try:
            if not self._readable.poll(timeout_s * 1000):
                return b""
            data = os.read(self._handle, _READ_SIZE)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise self._lost(error.strerror) from error
        if not data:
            raise self._lost("the other end hung up")
        return data

    def close(self) -> None:
        """Close the port."""
        self._handle = -1
        self._port.close()

    def _wait_until_writable(self) -> None:
        if not self._writable.poll(_WRITE_TIMEOUT_MS):
            raise LinkTimeoutError("takes no more bytes", where=self._name)

    def _lost(self, why: str | None) -> LinkLostError:
        return LinkLostError(f"the port is lost: {why}", where=self._name, mend="open it again")
