"""The links that are checked, each with the far end in the test's hand; another one is one more line."""

from __future__ import annotations

import os
import socket
import tty
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass

import serial

from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.serial_port import SerialStream, open_serial
from nxt_twin.brick.links.sockets import SocketStream
from nxt_twin.brick.links.stream import StreamLink
from nxt_twin.brick.links.tcp import open_tcp


@dataclass(frozen=True)
class FarEnd:
    """What the brick would hold in its hand.

    Attributes:
        read: takes the bytes that the link wrote.
        write: sends bytes to the link, framed or not.
        vanish: ends the connection without a word.
    """

    read: Callable[[], bytes]
    write: Callable[[bytes], object]
    vanish: Callable[[], None]


@dataclass(frozen=True)
class LinkPair:
    """A link and its far end."""

    link: Link
    far: FarEnd


@contextmanager
def _socket_pair() -> Iterator[LinkPair]:
    near, far = socket.socketpair()
    link = StreamLink(SocketStream(near, "pair"), SystemClock(), "pair")
    with far:
        yield LinkPair(link, _socket_end(far))
    link.close()


@contextmanager
def _tcp() -> Iterator[LinkPair]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        link = open_tcp(f"127.0.0.1:{listener.getsockname()[1]}", SystemClock())
        far, _ = listener.accept()
        with far:
            yield LinkPair(link, _socket_end(far))
        link.close()


@contextmanager
def _pty(open_port: Callable[[str], Link]) -> Iterator[LinkPair]:
    controller, terminal = os.openpty()
    tty.setraw(terminal)
    link = open_port(os.ttyname(terminal))
    os.close(terminal)
    gone: list[int] = []

    def vanish() -> None:
        os.close(controller)
        gone.append(controller)

    yield LinkPair(
        link,
        FarEnd(lambda: os.read(controller, 4096), lambda data: os.write(controller, data), vanish),
    )
    link.close()
    if not gone:
        os.close(controller)


def _by_pyserial(device: str) -> Link:
    """As on Windows, where ports are no files."""
    return StreamLink(SerialStream(serial.Serial(device, write_timeout=5), "port"), SystemClock(), "port")


def _socket_end(far: socket.socket) -> FarEnd:
    return FarEnd(lambda: far.recv(4096), far.sendall, far.close)


LINKS: dict[str, Callable[[], AbstractContextManager[LinkPair]]] = {
    "socket pair": _socket_pair,
    "tcp": _tcp,
    "pty": lambda: _pty(lambda device: open_serial(device, SystemClock())),
    "pty, by pyserial": lambda: _pty(_by_pyserial),
}
