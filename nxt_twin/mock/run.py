"""Serve a mock brick in real time until the user interrupts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.search.tcp import LOCAL_ADDRESS
from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.serve.dialect import Unframed
from nxt_twin.mock.serve.endpoint import Endpoint
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import Profile
from nxt_twin.mock.serve.tcp import TcpEndpoint
from nxt_twin.mock.start import Bodies, BodyChange, bare_body, profile_named, switch_on


@final
@dataclass(frozen=True)
class Served:
    """A served mock brick.

    Attributes:
        name: the brick's name.
        urls: where clients reach it.
    """

    name: str
    urls: tuple[str, ...]


def serve(
    *,
    clock: Clock,
    announce: Callable[[Served], None],
    tcp: str | None = None,
    tcp_raw: str | None = None,
    pty: Path | None = None,
    world: Path | None = None,
    seed: int = 0,
    profile: str | Profile = "none",
    change: BodyChange = lambda _: None,
    bodies: Bodies = bare_body,
    stop: Callable[[], bool] = lambda: False,
) -> None:
    """Serve a mock brick; blocks until `stop` says so or the user interrupts.

    A brick that switches itself off hangs up on its client and is switched on again at once, with its files.

    Args:
        clock: the machine's clock.
        announce: told once where the brick is reached.
        tcp: HOST:PORT to listen at; with no place at all, where the search for bricks looks.
        tcp_raw: HOST:PORT to listen at for nxt-python's socket backend.
        pty: where to put the symbolic link to a pseudo-terminal.
        world: a world file; without it the brick is as LEGO ships it.
        seed: of noise, jitter and faults.
        profile: delays and faults of the link, or their name (`nxt_twin.mock.serve.profile.PROFILES`).
        change: done to the brick's body each time before it is switched on.
        bodies: makes that body each time.
        stop: asked once a tick.

    Raises:
        WorldError: the world file is none.
        PlantError: a motor's plant in it is none.
        ServeError: a place at which the brick cannot be served.
    """
    link = profile_named(profile)
    host = Host(switch_on(world, seed, change=change, bodies=bodies), clock)
    endpoints: list[Endpoint] = []
    try:
        if tcp is not None or (pty is None and tcp_raw is None):
            endpoints.append(TcpEndpoint(host, parse_address(tcp or LOCAL_ADDRESS), link, seed))
        if tcp_raw is not None:
            endpoints.append(TcpEndpoint(host, parse_address(tcp_raw), link, seed + 2, Unframed()))
        if pty is not None:
            endpoints.append(_pty(host, pty, link, seed + 1))
        announce(Served(host.firmware.radio.brick_name, tuple(endpoint.url for endpoint in endpoints)))
        while not _run(host, endpoints, stop):
            for endpoint in endpoints:
                endpoint.hang_up()
            host.restart(switch_on(world, seed, host.firmware, change, bodies=bodies))
    finally:
        for endpoint in endpoints:
            endpoint.close()


def _run(host: Host, endpoints: Sequence[Endpoint], stop: Callable[[], bool]) -> bool:
    """Serve until told to stop (True), or until the brick is off (False)."""
    while host.running:
        if stop():
            return True
        host.rest()
        host.catch_up(
            leaving=1
        )  # after a stall: what came meanwhile was not there yet in the ticks that are late
        for endpoint in endpoints:
            endpoint.take_in()
        host.catch_up()
        for endpoint in endpoints:
            endpoint.hand_out()
    return False


def _pty(host: Host, link: Path, profile: Profile, seed: int) -> Endpoint:
    try:
        from nxt_twin.mock.serve.pty import PtyEndpoint
    except ImportError:
        mend = "serve it over TCP"
        raise ServeError("this system has no pseudo-terminals", where=str(link), mend=mend) from None
    return PtyEndpoint(host, link, profile, seed)


def parse_address(text: str) -> tuple[str, int]:
    """Host and port of ``HOST:PORT``; an IPv6 host stands in brackets.

    Raises:
        ServeError: it is not of that form.
    """
    name, colon, port = text.rpartition(":")
    name = name.removeprefix("[").removesuffix("]")
    if not (colon and name and port.isascii() and port.isdigit() and len(port) <= 5 and int(port) <= 0xFFFF):
        raise ServeError("is not HOST:PORT", where=repr(text), mend="such as 127.0.0.1:7000")
    return name, int(port)
