"""The bricks that the checks run against; another one is one more line."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from conformance_fake import FakeBrick
from conformance_serving import (
    OpenBrick,
    served_by_pty,
    served_by_socket_pair,
    served_by_tcp,
    served_directly,
)

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.mock.body.world import World
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink


@contextmanager
def _mock_in_virtual_time() -> Iterator[OpenBrick]:
    world, clock = World(), VirtualClock()
    host = Host(Firmware(world.body(0), world.identity()), clock)
    yield lambda: Brick(MockLink(host, late=LinkTimeoutError, lost=LinkLostError), clock)


BRICKS: dict[str, Callable[[], AbstractContextManager[OpenBrick]]] = {
    "fake, directly": lambda: served_directly(FakeBrick().answer),
    "fake, socket pair": lambda: served_by_socket_pair(FakeBrick().answer),
    "fake, tcp": lambda: served_by_tcp(FakeBrick().answer),
    "fake, pty": lambda: served_by_pty(FakeBrick().answer),
    "mock, in virtual time": _mock_in_virtual_time,
}
