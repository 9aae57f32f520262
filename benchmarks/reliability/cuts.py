"""A link that is cut after every byte of a telegram, either way: each ends in a named failure, none hangs."""

from __future__ import annotations

import os
import socket
import threading
import tty
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Final, Protocol, final

import firmware_protocol as fp
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkError
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.links.tcp import open_tcp
from nxt_twin.brick.policy import STREAM_POLICY

_REQUEST: Final = fp.frame(fp.encode_request(fp.GetOutputState(0)))
_REPLY: Final = fp.frame(bytes((2, fp.GetOutputState.OPCODE, 0)) + bytes(22))
_POLICY: Final = replace(STREAM_POLICY, reply_timeout_s=0.05, release_timeout_s=0.05)


class Far(Protocol):
    """The brick's end of a link."""

    def read(self, size: int) -> bytes:
        """Up to so many bytes."""
        ...

    def write(self, data: bytes) -> None:
        """All of them."""
        ...

    def close(self) -> None:
        """Cut."""
        ...


def report(every: int = 1) -> Iterator[str]:
    """What came of a cut after every (or every so many) byte of a request and of its reply, closed or held."""
    places = [*((n, 0) for n in range(len(_REQUEST))), *((len(_REQUEST), n) for n in range(len(_REPLY)))][
        ::every
    ]
    for name, pair in (("tcp", _tcp), ("serial", _serial)):
        seen = Counter(_cut(pair, *place, held=held) for held in (False, True) for place in places)
        told = ", ".join(f"{number} {what}" for what, number in seen.most_common())
        yield f"{name} cut after {len(places)} of {len(_REQUEST)} + {len(_REPLY)} bytes, closed and held: {told}"
    yield "usb and mock carry whole packets: between two there is nothing to cut"


def _cut(pair: Callable[[], tuple[Link, Far]], asked: int, answered: int, *, held: bool) -> str:
    link, far = pair()
    side = threading.Thread(target=_answer, args=(far, asked, answered, held))
    side.start()
    try:
        with Brick(link, SystemClock(), _POLICY) as brick:
            brick.motors.read(0)
        return "ANSWERED"
    except LinkError as failure:
        return type(failure).__name__
    finally:
        side.join()
        far.close()


def _answer(far: Far, asked: int, answered: int, held: bool) -> None:
    got = b""
    while len(got) < asked:
        got += far.read(asked - len(got))
    if answered:
        far.write(_REPLY[:answered])
    if not held:
        far.close()


@final
class _Socket:
    def __init__(self, connected: socket.socket) -> None:
        self._connected = connected

    def read(self, size: int) -> bytes:
        return self._connected.recv(size)

    def write(self, data: bytes) -> None:
        self._connected.sendall(data)

    def close(self) -> None:
        self._connected.close()


@final
class _Terminal:
    def __init__(self, handle: int) -> None:
        self._handle = handle

    def read(self, size: int) -> bytes:
        return os.read(self._handle, size)

    def write(self, data: bytes) -> None:
        os.write(self._handle, data)

    def close(self) -> None:
        if self._handle >= 0:
            with suppress(OSError):
                os.close(self._handle)
        self._handle = -1


def _tcp() -> tuple[Link, Far]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        link = open_tcp(f"127.0.0.1:{listener.getsockname()[1]}", SystemClock())
        return link, _Socket(listener.accept()[0])


def _serial() -> tuple[Link, Far]:
    far, near = os.openpty()
    tty.setraw(near)
    link = open_serial(os.ttyname(near), SystemClock())
    os.close(near)
    return link, _Terminal(far)
