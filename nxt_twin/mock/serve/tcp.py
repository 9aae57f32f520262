"""The mock brick over TCP, framed as on Bluetooth; one client after another."""

from __future__ import annotations

import errno
import socket
from typing import Final, final

from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.serve.endpoint import Endpoint
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import Profile

_READ_SIZE: Final = 4096


@final
class TcpEndpoint(Endpoint):
    """A listening socket. While a client is connected others wait in the queue.

    Args:
        host: the running brick.
        address: host and port to listen at; port 0 takes any free one.
        profile: delays and faults.
        seed: of the jitter and the faults.

    Raises:
        ServeError: the address cannot be listened at.
    """

    def __init__(self, host: Host, address: tuple[str, int], profile: Profile, seed: int = 0) -> None:
        name, port = address
        try:
            self._listener = socket.create_server((name, port), family=_family(name))
        except UnicodeError:
            raise ServeError("is no host's name", where=f"tcp:{name}:{port}") from None
        except OSError as error:
            busy = error.errno == errno.EADDRINUSE
            what = "another program listens there" if busy else f"cannot listen: {error.strerror or error}"
            mend = "take another port with --tcp HOST:PORT; port 0 is any free one"
            raise ServeError(what, where=f"tcp:{name}:{port}", mend=mend) from None
        self._host = host
        self._listener.setblocking(False)  # noqa: FBT003 - the library's interface
        self._line = host.connect(Transport.BLUETOOTH, profile, seed)
        self._client: socket.socket | None = None
        self._unsent = b""

    @property
    def address(self) -> tuple[str, int]:
        """Host and port that it listens at."""
        name, port = self._listener.getsockname()[:2]
        return str(name), int(port)

    @property
    def url(self) -> str:
        """Such as ``tcp:127.0.0.1:7000``."""
        name, port = self.address
        return f"tcp:[{name}]:{port}" if ":" in name else f"tcp:{name}:{port}"

    def take_in(self) -> None:
        """Accept a client, notice that one has gone, and read what it has sent."""
        if self._client is None:
            self._accept()
        if self._client is None:
            return
        try:
            data = self._client.recv(_READ_SIZE)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if data:
            self._line.write(data)
        else:
            self._drop()

    def hand_out(self) -> None:
        """Write what the brick has to say."""
        if self._client is None:
            return
        while waiting := self._unsent or self._line.read() or b"":
            try:
                sent = self._client.send(waiting)
            except BlockingIOError:
                sent = 0
            except OSError:
                self._drop()
                return
            self._unsent = waiting[sent:]
            if self._unsent:
                return

    def hang_up(self) -> None:
        """Close the connection to the client."""
        if self._client is not None:
            self._drop()

    def close(self) -> None:
        """Stop listening, and hang up on the client."""
        self.hang_up()
        self._listener.close()

    def _accept(self) -> None:
        if not self._host.take(self._line):
            return
        try:
            self._client, _ = self._listener.accept()
        except (BlockingIOError, ConnectionError):
            self._host.release(self._line)
            return
        self._client.setblocking(False)  # noqa: FBT003 - the library's interface
        self._client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None
        self._unsent = b""
        self._line.hang_up()
        self._host.release(self._line)


def _family(name: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in name else socket.AF_INET
