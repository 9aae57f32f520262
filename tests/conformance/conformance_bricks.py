"""The bricks that the checks run against; another one is one more line."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from conformance_fake import FakeBrick
from conformance_serving import (
    OpenBrick,
    served_by_pty,
    served_by_socket_pair,
    served_by_tcp,
    served_directly,
)

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.brick.links.usb import open_usb
from nxt_twin.brick.open import open_brick
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.run import serve
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink
from nxt_twin.mock.serve.usb import MockUsbBackend, ServedUsbDevice
from nxt_twin.mock.thread import served_in_thread


def _mock_host(clock: VirtualClock) -> Host:
    world = World()
    return Host(Firmware(world.body(0), world.identity()), clock)


@contextmanager
def _mock_in_virtual_time() -> Iterator[OpenBrick]:
    clock = VirtualClock()
    host = _mock_host(clock)
    yield lambda: Brick(MockLink(host, late=LinkTimeoutError, lost=LinkLostError), clock)


@contextmanager
def _mock_on_usb() -> Iterator[OpenBrick]:
    """Our own USB link and all of pyusb, down to the bus; in virtual time, as the bus is in this process."""
    clock = VirtualClock()
    bus = MockUsbBackend([ServedUsbDevice(_mock_host(clock))])
    yield lambda: Brick(open_usb("", clock, backend=bus), clock)


@contextmanager
def _mock_by_url(**place: str | Path) -> Iterator[OpenBrick]:
    """In real time, as `nxt-twin mock` serves it."""
    with served_in_thread(partial(serve, clock=SystemClock(), **place)) as served:
        yield lambda: open_brick(served.urls[0], SystemClock())


@contextmanager
def _mock_on_pty() -> Iterator[OpenBrick]:
    with TemporaryDirectory() as folder, _mock_by_url(pty=Path(folder, "brick")) as opener:
        yield opener


BRICKS: dict[str, Callable[[], AbstractContextManager[OpenBrick]]] = {
    "fake, directly": lambda: served_directly(FakeBrick().answer),
    "fake, socket pair": lambda: served_by_socket_pair(FakeBrick().answer),
    "fake, tcp": lambda: served_by_tcp(FakeBrick().answer),
    "fake, pty": lambda: served_by_pty(FakeBrick().answer),
    "mock, in virtual time": _mock_in_virtual_time,
    "mock, usb": _mock_on_usb,
    "mock, tcp": lambda: _mock_by_url(tcp="127.0.0.1:0"),
    "mock, pty": _mock_on_pty,
}
