"""The mock brick over TCP, one client after another; framed as on Bluetooth, or as nxt-python's server is not."""

from __future__ import annotations

import errno
import socket
from contextlib import suppress
from typing import Final, final

from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.serve.dialect import Dialect, Framed
from nxt_twin.mock.serve.endpoint import Endpoint
from nxt_twin.mock.serve.guests import Guests
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import Profile

HALF_MOST_S: Final = 5.0
_READ_SIZE: Final = 4096


@final
class TcpEndpoint(Endpoint):
    """A listening socket. While a client is connected others are told so, unless it leaves at once.

    A client that sends a part of a telegram and then nothing for some seconds is let go: others would wait for ever.

    Args:
        host: the running brick.
        address: host and port to listen at; port 0 takes any free one.
        profile: delays and faults.
        seed: of the jitter and the faults.
        dialect: how telegrams are told apart.

    Raises:
        ServeError: the address cannot be listened at.
    """

    def __init__(
        self,
        host: Host,
        address: tuple[str, int],
        profile: Profile,
        seed: int = 0,
        dialect: Dialect | None = None,
    ) -> None:
        name, port = address
        self._dialect = dialect or Framed()
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
        self._line = host.connect(self._dialect.transport, profile, seed)
        self._guests = Guests(self._dialect, host.clock)
        self._client: socket.socket | None = None
        self._unsent = b""
        self._half = b""
        self._heard_s = 0.0
        self._first = True

    @property
    def address(self) -> tuple[str, int]:
        """Host and port that it listens at."""
        name, port = self._listener.getsockname()[:2]
        return str(name), int(port)

    @property
    def url(self) -> str:
        """Such as ``tcp:127.0.0.1:7000``."""
        name, port = self.address
        scheme = self._dialect.scheme
        return f"{scheme}:[{name}]:{port}" if ":" in name else f"{scheme}:{name}:{port}"

    def take_in(self) -> None:
        """Accept a client, notice that one has gone, and read what it has sent."""
        self._accept()
        if self._client is not None:
            self._read(self._client)
        self._guests.turn_away()

    def _read(self, client: socket.socket) -> None:
        try:
            data = client.recv(_READ_SIZE)
        except BlockingIOError:
            if self._half and self._host.clock.now_s() - self._heard_s > HALF_MOST_S:
                self._drop()
            return
        except OSError:
            data = b""
        if data:
            self._hear(data)
        else:
            self._drop()

    def _hear(self, data: bytes) -> None:
        heard = self._dialect.hear(data, first=self._first)
        self._first = False
        self._half, self._heard_s = self._dialect.rest(self._half + data), self._host.clock.now_s()
        self._unsent += heard.answer
        for part in heard.parts:
            self._line.write(part)
        if heard.bye:
            self._say()
            self._drop()

    def hand_out(self) -> None:
        """Write what the brick has to say."""
        if self._client is not None:
            self._say()

    def _say(self) -> None:
        while self._client is not None and (waiting := self._unsent or self._line.read() or b""):
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
        self._guests.close()
        self._listener.close()

    def _accept(self) -> None:
        with suppress(BlockingIOError, ConnectionError):
            self._guests.add(self._listener.accept()[0])
        if self._client is not None or not self._host.take(self._line):
            return
        self._client = self._guests.next()
        if self._client is None:
            self._host.release(self._line)
        else:
            self._client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None
        self._unsent = self._half = b""
        self._first = True
        self._line.hang_up()
        self._host.release(self._line)


def _family(name: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in name else socket.AF_INET
