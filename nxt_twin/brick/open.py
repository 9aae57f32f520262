"""Open a link, or a whole brick, by its URL."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final, TextIO

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.link import Link
from nxt_twin.brick.policy import PACKET_POLICY, STREAM_POLICY
from nxt_twin.brick.tap import TappedLink
from nxt_twin.brick.url import parse_url

Opener = Callable[[str, Clock], Link]
"""Opens a link: from the address (the URL behind its scheme) and the clock."""

NO_OPENERS: Final[Mapping[str, Opener]] = MappingProxyType({})

_STREAM_SCHEMES: Final = ("bt", "serial", "tcp")


def open_link(url: str, clock: Clock, openers: Mapping[str, Opener] = NO_OPENERS) -> Link:
    """Open the link that a URL names.

    Args:
        url: ``usb:``, ``usb:SERIAL``, ``bt:ADDRESS``, ``serial:DEVICE``, ``tcp:HOST:PORT``, or another
            scheme of `openers`.
        clock: measures timeouts.
        openers: further schemes, such as ``mock``, and what opens them.

    Raises:
        LinkUrlError: no such scheme, or an address that it cannot read.
        LinkRefusedError: the link cannot be opened.
    """
    known = {**_OPENERS, **openers}
    wanted = parse_url(url, known)
    return known[wanted.scheme](wanted.address, clock)


def open_brick(
    url: str, clock: Clock, openers: Mapping[str, Opener] = NO_OPENERS, *, tap: TextIO | None = None
) -> Brick:
    """Open a brick by its URL, with the timeouts and sizes that suit the link.

    Args:
        url: as with `open_link`.
        clock: stamps requests and replies, and waits.
        openers: as with `open_link`.
        tap: where to record every telegram, if anywhere; see `nxt_twin.brick.tap`.

    Raises:
        LinkUrlError: as with `open_link`.
        LinkRefusedError: as with `open_link`.
    """
    link = open_link(url, clock, openers)
    if tap is not None:
        link = TappedLink(link, clock, tap)
    scheme = parse_url(url, {**_OPENERS, **openers}).scheme
    return Brick(link, clock, STREAM_POLICY if scheme in _STREAM_SCHEMES else PACKET_POLICY)


# Each library is imported only when its scheme is used: a missing one spoils no other way.


def _open_usb(address: str, clock: Clock) -> Link:
    from nxt_twin.brick.links.usb import open_usb

    return open_usb(address, clock)


def _open_bluetooth(address: str, clock: Clock) -> Link:
    from nxt_twin.brick.links.bluetooth import open_bluetooth

    return open_bluetooth(address, clock)


def _open_serial(address: str, clock: Clock) -> Link:
    from nxt_twin.brick.links.serial_port import open_serial

    return open_serial(address, clock)


def _open_tcp(address: str, clock: Clock) -> Link:
    from nxt_twin.brick.links.tcp import open_tcp

    return open_tcp(address, clock)


_OPENERS: Final[Mapping[str, Opener]] = MappingProxyType(
    {"usb": _open_usb, "bt": _open_bluetooth, "serial": _open_serial, "tcp": _open_tcp}
)
