"""A mock brick on this machine; other machines' cannot be searched, only named."""

from __future__ import annotations

from typing import Final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.links.tcp import open_tcp
from nxt_twin.brick.policy import STREAM_POLICY
from nxt_twin.brick.search.finding import FoundBrick, WayReport

LOCAL_ADDRESS: Final = "localhost:7000"
"""Where a mock brick is looked for."""

_CONNECT_TIMEOUT_S: Final = 1.0


def look_on_tcp(clock: Clock, *, address: str = LOCAL_ADDRESS) -> WayReport:
    """The mock brick that listens at the address, if one does; it is asked for its name.

    Args:
        clock: measures timeouts.
        address: ``HOST:PORT``.

    Raises:
        LinkRefusedError: nobody listens there.
        LinkError: who listens is no brick.
    """
    with Brick(open_tcp(address, clock, timeout_s=_CONNECT_TIMEOUT_S), clock, STREAM_POLICY) as brick:
        name = brick.device.info().value.name
    return WayReport("tcp", (FoundBrick(f"tcp:{address}", name),))
