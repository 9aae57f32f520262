"""A brick's URL: a scheme that says how it is reached, and an address that the scheme understands."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final, NamedTuple

from nxt_twin.brick.errors import LinkUrlError

_BLUETOOTH_ADDRESS: Final = re.compile(r"[0-9A-F]{2}(:[0-9A-F]{2}){5}")
_USB_SERIAL: Final = re.compile(r"[0-9A-F]{12}")
_PORT_MAX: Final = 0xFFFF
_PORT_DIGITS: Final = 5


class LinkUrl(NamedTuple):
    """Such as ``tcp:localhost:7000``: scheme ``tcp``, address ``localhost:7000``."""

    scheme: str
    address: str

    def __str__(self) -> str:
        """The URL as it was."""
        return f"{self.scheme}:{self.address}"


def parse_url(url: str, schemes: Iterable[str]) -> LinkUrl:
    """Take a URL apart.

    Args:
        url: what the user gave.
        schemes: the schemes there are.

    Raises:
        LinkUrlError: it has none of them.
    """
    scheme, colon, address = url.partition(":")
    known = tuple(schemes)
    if not colon or scheme.lower() not in known:
        valid = ", ".join(f"{each}:" for each in known)
        raise LinkUrlError("has no scheme that leads to a brick", where=repr(url), mend=f"one of {valid}")
    return LinkUrl(scheme.lower(), address)


def checked_bluetooth_address(address: str) -> str:
    """The address in upper case.

    Raises:
        LinkUrlError: it is not six bytes.
    """
    wanted = address.upper()
    if not _BLUETOOTH_ADDRESS.fullmatch(wanted):
        raise LinkUrlError(
            "is not a Bluetooth address", where=f"bt:{address}", mend="such as bt:00:16:53:01:02:03"
        )
    return wanted


def usb_serial(address: str) -> str:
    """The serial number in upper case, with or without colons in the URL; empty for any brick.

    Raises:
        LinkUrlError: it is not twelve hexadecimal digits.
    """
    wanted = address.upper().replace(":", "")
    if wanted and not _USB_SERIAL.fullmatch(wanted):
        raise LinkUrlError(
            "is not a serial number of twelve hexadecimal digits",
            where=f"usb:{address}",
            mend="usb: alone takes the only brick there is",
        )
    return wanted


def host_and_port(address: str) -> tuple[str, int]:
    """The two parts of a TCP address; an IPv6 host stands in brackets.

    Raises:
        LinkUrlError: one of them is missing, or the port is none.
    """
    host, colon, port = address.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    is_port = port.isascii() and port.isdigit() and len(port) <= _PORT_DIGITS and 0 < int(port) <= _PORT_MAX
    if not (colon and host and is_port) or "/" in host:  # a web address is none
        raise LinkUrlError("is not HOST:PORT", where=f"tcp:{address}", mend="such as tcp:localhost:7000")
    return host, int(port)
