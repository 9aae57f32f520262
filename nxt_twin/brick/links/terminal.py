"""An open terminal as a stream of bytes, by the system's own calls: several times quicker than pyserial's."""

from __future__ import annotations

import os
import select
import termios
from typing import Final, final

import serial

from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError

_write, _read = os.write, os.read
_WRITE_TIMEOUT_MS: Final = 5000
_READ_SIZE: Final = 4096
_READ_WAITS_S: Final = 0.1
"""How long a read waits by itself: the smallest time, other than none, that terminals know."""
_CHARACTERS: Final = 6
"""Where `termios` has VMIN and VTIME among a terminal's settings."""


@final
class TerminalStream:
    """Reads and writes a serial port where ports are files (not on Windows).

    While question and answer take turns each is a single call: a read waits by itself, and what follows an
    answer finds room. Otherwise the system is asked first, so that nothing blocks for ever.

    Args:
        port: the open port, which pyserial has set up and locked, and which the stream takes over.
        name: what a person calls the link.

    Raises:
        termios.error: the settings of a terminal cannot be changed.
    """

    def __init__(self, port: serial.Serial, name: str) -> None:
        self._port = port
        self._name = name
        self._handle: int = port.fileno()
        self._unanswered = False
        self._readable = select.poll()
        self._readable.register(self._handle, select.POLLIN)
        self._writable = select.poll()
        self._writable.register(self._handle, select.POLLOUT)
        _let_reads_wait(self._handle)

    def write(self, data: bytes) -> None:
        """Hand all bytes over; errors as with `ByteStream`."""
        try:
            sent = 0 if self._unanswered else _write(self._handle, data)
            if sent < len(data):
                self._write_as_it_fits(data[sent:])
        except OSError as error:
            raise self._lost(error.strerror) from error
        self._unanswered = True

    def read(self, timeout_s: float) -> bytes:
        """The bytes that have arrived, once there are any; errors as with `ByteStream`."""
        try:
            data = b""
            if timeout_s >= _READ_WAITS_S:
                data = _read(self._handle, _READ_SIZE)
                timeout_s -= _READ_WAITS_S
            if not data:
                if not self._readable.poll(timeout_s * 1000):
                    return b""
                data = os.read(self._handle, _READ_SIZE)
        except OSError as error:
            raise self._lost(error.strerror) from error
        if not data:
            raise self._lost("the other end hung up")
        self._unanswered = False
        return data

    def close(self) -> None:
        """Close the port."""
        self._handle = -1
        self._port.close()

    def _write_as_it_fits(self, data: bytes) -> None:
        """What was written before may still be on its way, and fill the system's buffers."""
        os.set_blocking(self._handle, False)
        try:
            while data:
                if not self._writable.poll(_WRITE_TIMEOUT_MS):
                    raise LinkTimeoutError("takes no more bytes", where=self._name)
                data = data[os.write(self._handle, data) :]
        finally:
            os.set_blocking(self._handle, True)

    def _lost(self, why: str | None) -> LinkLostError:
        return LinkLostError(f"the port is lost: {why}", where=self._name, mend="open it again")


def _let_reads_wait(handle: int) -> None:
    settings = termios.tcgetattr(handle)
    settings[_CHARACTERS][termios.VMIN] = 0
    settings[_CHARACTERS][termios.VTIME] = round(10 * _READ_WAITS_S)
    termios.tcsetattr(handle, termios.TCSANOW, settings)
    os.set_blocking(handle, True)
