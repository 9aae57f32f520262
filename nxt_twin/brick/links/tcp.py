"""``tcp:HOST:PORT``: a brick behind a network socket, with the framing of Bluetooth."""

from __future__ import annotations

import socket
from typing import Final

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkRefusedError, Refusal
from nxt_twin.brick.links.sockets import SocketStream
from nxt_twin.brick.links.stream import StreamLink
from nxt_twin.brick.url import host_and_port

CONNECT_TIMEOUT_S: Final = 5.0


def open_tcp(address: str, clock: Clock, *, timeout_s: float = CONNECT_TIMEOUT_S) -> StreamLink:
    """Connect to a brick, most likely a mock one.

    Args:
        address: ``HOST:PORT``; an IPv6 host stands in brackets.
        clock: measures timeouts.
        timeout_s: how long connecting may take.

    Raises:
        LinkUrlError: the address is not one.
        LinkRefusedError: nobody listens there, or the host is unknown or out of reach.
    """
    url = f"tcp:{address}"
    try:
        connected = socket.create_connection(host_and_port(address), timeout=timeout_s)
    except ConnectionRefusedError as error:
        raise LinkRefusedError(
            "nobody listens there",
            cause=Refusal.NOT_FOUND,
            where=url,
            mend=f"start one: nxt-twin mock --tcp {address}",
        ) from error
    except UnicodeError as error:  # a name that the Internet's rules forbid, such as two dots in a row
        raise LinkRefusedError("is no host's name", cause=Refusal.UNREACHABLE, where=url) from error
    except OSError as error:
        raise LinkRefusedError(
            f"cannot be reached: {error.strerror or error}", cause=Refusal.UNREACHABLE, where=url
        ) from error
    connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return StreamLink(SocketStream(connected, url), clock, url)
