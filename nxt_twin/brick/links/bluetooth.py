"""``bt:00:16:53:…``: Bluetooth's serial port profile by a socket, where Python and the kernel have them."""

from __future__ import annotations

import errno
import socket
from types import ModuleType
from typing import Any, Final

from firmware_protocol.bluetooth import CHANNEL, DEFAULT_PIN
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkRefusedError, Refusal
from nxt_twin.brick.links.sockets import SocketStream
from nxt_twin.brick.links.stream import StreamLink
from nxt_twin.brick.url import checked_bluetooth_address

CONNECT_TIMEOUT_S: Final = 15.0
"""The radio looks for a brick for ten seconds before it gives up."""

_NO_ADAPTER: Final = (errno.ENODEV, errno.ENETDOWN, errno.EHOSTUNREACH, errno.ENETUNREACH)
_NOT_PAIRED: Final = (errno.EACCES, errno.EPERM, errno.EBADE, errno.ECONNREFUSED)


def lacks_sockets(sockets: ModuleType) -> str:
    """What keeps this Python from opening Bluetooth sockets, in a sentence; empty if nothing does."""
    if not hasattr(sockets, "AF_BLUETOOTH"):
        return "this Python was built without Bluetooth sockets"
    try:
        _new_socket(sockets).close()
    except OSError as error:
        return f"this system's kernel has no Bluetooth ({error.strerror or error})"
    return ""


def serial_port_advice(address: str) -> str:
    """How to reach the brick of that address without Bluetooth sockets."""
    return (
        f"bind a serial port: sudo rfcomm bind 0 {address} {CHANNEL}, then use serial:/dev/rfcomm0."
        " On Windows and macOS pair the brick and take its outgoing serial port"
    )


def open_bluetooth(
    address: str, clock: Clock, *, timeout_s: float = CONNECT_TIMEOUT_S, sockets: ModuleType = socket
) -> StreamLink:
    """Connect to a paired brick.

    Args:
        address: the brick's Bluetooth address.
        clock: measures timeouts.
        timeout_s: how long connecting may take.
        sockets: the module `socket`, or what stands for it.

    Raises:
        LinkUrlError: the address is not one.
        LinkRefusedError: Python or kernel have no Bluetooth, there is no adapter, or the brick is off, out of
            reach, not paired or busy.
    """
    wanted = checked_bluetooth_address(address)
    url = f"bt:{wanted}"
    lack = lacks_sockets(sockets)
    if lack:
        raise LinkRefusedError(lack, cause=Refusal.NO_DRIVER, where=url, mend=serial_port_advice(wanted))
    connected = _new_socket(sockets)
    connected.settimeout(timeout_s)
    try:
        connected.connect((wanted, CHANNEL))
    except OSError as error:
        connected.close()
        raise _refusal(url, error) from error
    return StreamLink(SocketStream(connected, url), clock, url)


def _new_socket(sockets: ModuleType) -> socket.socket:
    # By name, because type checkers and some builds of Python do not know them.
    names: dict[str, Any] = vars(sockets)
    made: socket.socket = sockets.socket(names["AF_BLUETOOTH"], sockets.SOCK_STREAM, names["BTPROTO_RFCOMM"])
    return made


def _refusal(url: str, error: OSError) -> LinkRefusedError:
    text = error.strerror or str(error) or "no answer"
    if error.errno in _NO_ADAPTER:
        return LinkRefusedError(
            f"no Bluetooth adapter is switched on ({text})",
            cause=Refusal.NO_ADAPTER,
            where=url,
            mend="plug one in; bluetoothctl power on",
        )
    if error.errno in _NOT_PAIRED:
        return LinkRefusedError(
            f"the brick does not let this computer in ({text})",
            cause=Refusal.NO_PERMISSION,
            where=url,
            mend=f"pair it: bluetoothctl pair {url[3:]}, PIN {DEFAULT_PIN}",
        )
    if error.errno == errno.EBUSY:
        return LinkRefusedError(
            "another program holds the connection", cause=Refusal.BUSY, where=url, mend="close it there"
        )
    return LinkRefusedError(
        f"the brick does not answer ({text})",
        cause=Refusal.UNREACHABLE,
        where=url,
        mend="switch it and its Bluetooth on, and bring it near",
    )
