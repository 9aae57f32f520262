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
from types import ModuleType
from typing import Final, Protocol, cast, final

import firmware_protocol as fp
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkError
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.bluetooth import open_bluetooth
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.links.tcp import open_tcp
from nxt_twin.brick.links.usb import open_usb
from nxt_twin.brick.policy import PACKET_POLICY, STREAM_POLICY
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.usb import MockUsbBackend, ServedUsbDevice
from nxt_twin.mock.start import switch_on

_PACKETS: Final = 4
_REQUEST: Final = fp.frame(fp.encode_request(fp.GetOutputState(0)))
_REPLY: Final = fp.frame(bytes((2, fp.GetOutputState.OPCODE, 0)) + bytes(22))
_POLICY: Final = replace(STREAM_POLICY, reply_timeout_s=0.05, release_timeout_s=0.05)


class Far(Protocol):
    """The brick's end of a link."""

    def read(self, size: int) -> bytes:
        """Up to a number of bytes."""
        ...

    def write(self, data: bytes) -> None:
        """All of them."""
        ...

    def close(self) -> None:
        """Cut."""
        ...


def report(every: int = 1) -> Iterator[str]:
    """What came of cuts after each `every`-th byte of a request and of its reply, closed or held."""
    places = [*((n, 0) for n in range(len(_REQUEST))), *((len(_REQUEST), n) for n in range(len(_REPLY)))][
        ::every
    ]
    for name, pair in (("tcp", _tcp), ("serial", _serial), ("bluetooth", _bluetooth)):
        seen = Counter(_cut(pair, *place, held=held) for held in (False, True) for place in places)
        told = ", ".join(f"{number} {what}" for what, number in seen.most_common())
        yield f"{name} cut after {len(places)} of {len(_REQUEST)} + {len(_REPLY)} bytes, closed and held: {told}"
    told = ", ".join(_pulled(requests) for requests in range(_PACKETS))
    yield f"usb pulled before each of {_PACKETS} packets, which arrive whole or not at all: {told}"


def _pulled(packets: int) -> str:
    """A USB cable that is pulled before a packet."""
    clock = VirtualClock()
    device = ServedUsbDevice(Host(switch_on(), clock))
    link = open_usb("", clock, backend=MockUsbBackend([device]))
    try:
        with Brick(_Cable(link, device, packets), clock, PACKET_POLICY) as brick:
            brick.motors.read(0)
            brick.motors.read(1)
        return "ANSWERED"
    except LinkError as failure:
        return type(failure).__name__


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
        with suppress(BrokenPipeError):  # on a busy machine, the near end has given up by now
            far.write(_REPLY[:answered])
    if not held:
        far.close()


@final
class _Cable:
    """A link over USB whose cable is pulled before one of its packets, either way."""

    def __init__(self, link: Link, device: ServedUsbDevice, packets: int) -> None:
        self._link, self._device, self._left = link, device, packets

    def send(self, telegram: bytes) -> None:
        self._pass()
        self._link.send(telegram)

    def receive(self, timeout_s: float) -> bytes:
        self._pass()
        return self._link.receive(timeout_s)

    def close(self) -> None:
        self._link.close()

    def describe(self) -> str:
        return self._link.describe()

    def _pass(self) -> None:
        if not self._left:
            self._device.unplug()
        self._left -= 1


@final
class _Radio:
    """Stands for the module `socket` on a machine with Bluetooth, and for the socket: one of a pair."""

    SOCK_STREAM = socket.SOCK_STREAM

    def __init__(self, near: socket.socket) -> None:
        self.AF_BLUETOOTH, self.BTPROTO_RFCOMM = 31, 3  # looked up in the module's own dictionary
        self.settimeout, self.fileno, self.send, self.recv = (
            near.settimeout,
            near.fileno,
            near.send,
            near.recv,
        )
        self._near, self._asked = near, 0

    def socket(self, *_: int) -> _Radio:
        return self

    def connect(self, _: tuple[str, int]) -> None:
        """Connected already."""

    def close(self) -> None:
        self._asked += 1
        if self._asked > 1:  # the first one only asks whether there are such sockets
            self._near.close()


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


def _bluetooth() -> tuple[Link, Far]:
    near, far = socket.socketpair()
    radio = cast("ModuleType", _Radio(near))
    return open_bluetooth("00:16:53:00:00:01", SystemClock(), sockets=radio), _Socket(far)


def _serial() -> tuple[Link, Far]:
    far, near = os.openpty()
    tty.setraw(near)
    link = open_serial(os.ttyname(near), SystemClock())
    os.close(near)
    return link, _Terminal(far)
