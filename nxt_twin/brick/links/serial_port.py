"""``serial:DEVICE``: a serial port that Bluetooth provides (rfcomm, COM, tty), or a pseudo-terminal."""

from __future__ import annotations

import errno
from typing import Any, Final, final

import serial

from firmware_protocol.bluetooth import DEFAULT_PIN
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkLostError, LinkRefusedError, LinkTimeoutError, LinkUrlError, Refusal
from nxt_twin.brick.links.stream import ByteStream, StreamLink

_WRITE_TIMEOUT_S: Final = 5.0
_BUSY: Final = (errno.EBUSY, errno.EAGAIN)
_MISSING: Final = (errno.ENOENT, errno.ENODEV, errno.ENXIO, errno.ENOTDIR)
_FAR: Final = (errno.EHOSTDOWN, errno.EHOSTUNREACH, errno.ECONNREFUSED, errno.ETIMEDOUT, errno.ECONNRESET)


@final
class SerialStream:
    """Reads and writes a serial port by pyserial, as on Windows.

    Args:
        port: the open port, which the stream takes over.
        name: what a person calls the link.
    """

    def __init__(self, port: serial.Serial, name: str) -> None:
        self._port = port
        self._name = name

    def write(self, data: bytes) -> None:
        """Hand all bytes over; errors as with `ByteStream`."""
        try:
            self._port.write(data)
        except serial.SerialTimeoutException as error:
            raise LinkTimeoutError("takes no more bytes", where=self._name) from error
        except OSError as error:
            raise self._lost(error) from error

    def read(self, timeout_s: float) -> bytes:
        """The bytes that have arrived, once there are any; errors as with `ByteStream`."""
        port = self._port
        try:
            # Setting a timeout sets the whole port up anew.
            if port.timeout != timeout_s:
                port.timeout = timeout_s
            data: bytes = port.read(1)
            waiting = port.in_waiting if data else 0
            return data + port.read(waiting) if waiting else data
        except OSError as error:
            raise self._lost(error) from error

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def _lost(self, error: OSError) -> LinkLostError:
        return LinkLostError(f"the port is lost: {error}", where=self._name, mend="open it again")


def open_serial(device: str, clock: Clock) -> StreamLink:
    """Open a serial port behind which a brick is.

    Args:
        device: its name: ``/dev/rfcomm0``, ``COM5``, ``/dev/tty.NXT-DevB``.
        clock: measures timeouts.

    Raises:
        LinkUrlError: no device is named.
        LinkRefusedError: there is no such port, it may not be opened, it is in use, or the brick behind it is
            off or out of reach.
    """
    url = f"serial:{device}"
    if not device:
        raise LinkUrlError("names no device", where=url, mend="such as serial:/dev/rfcomm0 or serial:COM5")
    try:
        port = serial.Serial(device, write_timeout=_WRITE_TIMEOUT_S, **_exclusively())
    except (OSError, ValueError) as error:
        raise _refusal(url, device, error) from error
    return StreamLink(_stream(port, url), clock, url)


def _stream(port: serial.Serial, url: str) -> ByteStream:
    """Ports are files, and settings of terminals exist, everywhere but on Windows."""
    if not hasattr(port, "fileno"):
        return SerialStream(port, url)
    from nxt_twin.brick.links.terminal import TerminalStream

    return TerminalStream(port, url)


def _exclusively() -> dict[str, Any]:
    """Windows opens ports for one program anyway, and knows no such setting."""
    return {"exclusive": True} if hasattr(serial.Serial, "exclusive") else {}


def _refusal(url: str, device: str, error: Exception) -> LinkRefusedError:
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        return LinkRefusedError(
            "may not be opened by this user",
            cause=Refusal.NO_PERMISSION,
            where=url,
            mend="sudo usermod -aG dialout $USER, then log in again",
        )
    if number in _BUSY:
        return LinkRefusedError(
            "another program has it open", cause=Refusal.BUSY, where=url, mend=f"find it: fuser {device}"
        )
    if number in _MISSING:
        return LinkRefusedError(
            "there is no such port",
            cause=Refusal.NOT_FOUND,
            where=url,
            mend="sudo rfcomm bind 0 ADDRESS 1 makes /dev/rfcomm0",
        )
    if number in _FAR:
        return LinkRefusedError(
            "the brick behind it does not answer",
            cause=Refusal.UNREACHABLE,
            where=url,
            mend=f"switch it and its Bluetooth on, and pair it (PIN {DEFAULT_PIN})",
        )
    return LinkRefusedError(f"cannot be opened: {error}", cause=Refusal.NO_DRIVER, where=url)
