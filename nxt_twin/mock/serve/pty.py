"""The mock brick on a pseudo-terminal, framed as on Bluetooth: what a bound rfcomm device is to a client."""

from __future__ import annotations

import os
import termios
import tty
from contextlib import suppress
from pathlib import Path
from typing import Final, final

from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.serve.endpoint import Endpoint
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import Profile

_READ_SIZE: Final = 4096


@final
class PtyEndpoint(Endpoint):
    """A pseudo-terminal, found by a symbolic link.

    Args:
        host: the running brick.
        link: where to put the symbolic link; one that is there already is replaced, any other file refused.
        profile: delays and faults.
        seed: of the jitter and the faults.

    Raises:
        ServeError: the link cannot be made.
    """

    def __init__(self, host: Host, link: Path, profile: Profile, seed: int = 0) -> None:
        self._master, slave = os.openpty()
        self._device = os.ttyname(slave)
        tty.setraw(slave)
        os.close(slave)
        os.set_blocking(self._master, False)
        try:
            _point(link, self._device)
        except OSError as error:
            os.close(self._master)
            what = f"cannot be made a link: {error.strerror}"
            raise ServeError(what, where=str(link), mend="take another name") from None
        self._host = host
        self._link = link
        self._line = host.connect(Transport.BLUETOOTH, profile, seed)
        self._client_there = False

    @property
    def url(self) -> str:
        """Such as ``serial:nxt``."""
        return f"serial:{self._link}"

    def take_in(self) -> None:
        """Notice that a client has come or gone, and read what it has sent."""
        if not self._host.take(self._line):
            return
        try:
            data = os.read(self._master, _READ_SIZE)
        except BlockingIOError:
            self._client_there = True
            return
        except OSError:  # EIO: nobody has the terminal open
            self._drop()
            return
        self._client_there = True
        self._line.write(data)

    def hand_out(self) -> None:
        """Write what the brick has to say, each reply in one piece."""
        while self._client_there and (frame := self._line.read()) is not None:
            # A client that reads nothing fills the terminal; a radio would lose the reply as well.
            with suppress(BlockingIOError):
                os.write(self._master, frame)

    def hang_up(self) -> None:
        """Forget the client; it keeps the terminal open and finds a silent brick, then a new one."""
        self._drop()

    def close(self) -> None:
        """Remove the link and the terminal."""
        if self._link.is_symlink() and str(self._link.readlink()) == self._device:
            self._link.unlink()
        self._drop()
        os.close(self._master)

    def _drop(self) -> None:
        if self._client_there:
            self._client_there = False
            self._discard()
            self._line.hang_up()
        self._host.release(self._line)

    def _discard(self) -> None:
        """Throw away what the client has not read, which the next one would find."""
        with suppress(OSError, termios.error):
            slave = os.open(self._device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
            termios.tcflush(slave, termios.TCIOFLUSH)
            os.close(slave)


def _point(link: Path, device: str) -> None:
    if link.is_symlink():
        link.unlink()
    link.symlink_to(device)
