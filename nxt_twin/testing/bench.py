"""Mock bricks for tests: one in virtual time with our typed client, one in real time for any client."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.mock.body.body import Body
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.run import parse_address, serve
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.link import MockLink
from nxt_twin.mock.start import switch_on
from nxt_twin.mock.thread import served_in_thread
from nxt_twin.testing.settings import MockSettings

_ANY_PORT = "127.0.0.1:0"


@final
@dataclass(frozen=True)
class MockBench:
    """A mock brick in virtual time: time passes when the client waits, or when a test lets it, and then at once.

    Attributes:
        brick: the client, connected.
        body: battery, motors and sensors, to set and to look at.
        host: what runs the firmware.
        clock: the time that all of it goes by.
    """

    brick: Brick
    body: Body
    host: Host
    clock: VirtualClock

    @property
    def firmware(self) -> Firmware:
        """The firmware, to look into and to switch off."""
        return self.host.firmware

    def wait(self, duration_s: float) -> None:
        """Let time pass."""
        self.clock.sleep(duration_s)
        self.host.catch_up()


@contextmanager
def open_bench(settings: MockSettings) -> Iterator[MockBench]:
    """Switch a mock brick on and connect to it.

    Raises:
        NxtTwinError: the settings name what there is not.
    """
    clock = VirtualClock()
    bodies: list[Body] = []

    def change(body: Body) -> None:
        settings.change(body)
        bodies.append(body)

    host = Host(switch_on(settings.world, settings.seed, change=change, ready=False), clock)
    link = MockLink(host, settings.profile, seed=settings.seed, late=LinkTimeoutError, lost=LinkLostError)
    with Brick(link, clock) as brick:
        yield MockBench(brick, bodies[0], host, clock)


@final
@dataclass(frozen=True)
class ServedMock:
    """A mock brick in real time, in a thread; one client at a time is connected.

    Attributes:
        name: the brick's name.
        url: for our own clients, such as ``tcp:127.0.0.1:40001``; framed as on Bluetooth.
        address: host and port of `url`.
        raw_address: host and port that speak nxt-python's socket backend.
        device: a pseudo-terminal that is what a bound rfcomm device is; None where the system has none.
        body: battery, motors and sensors, to set while it runs.
    """

    name: str
    url: str
    address: tuple[str, int]
    raw_address: tuple[str, int]
    device: Path | None
    body: Body

    @property
    def nxt_python_config(self) -> str:
        """The text of a ``.nxt-python.conf`` with which nxt-python's programs find this brick unchanged."""
        if self.device is not None:
            return f"[default]\nbackends = devfile\nfilename = {self.device}\n"
        host, port = self.raw_address
        return f"[default]\nbackends = socket\nserver_host = {host}\nserver_port = {port}\n"


@contextmanager
def serve_mock(settings: MockSettings, scratch: Path) -> Iterator[ServedMock]:
    """Serve a mock brick at all its places while the block lasts.

    Args:
        settings: what is asked of it.
        scratch: a folder for the link to the pseudo-terminal.

    Raises:
        NxtTwinError: the settings name what there is not, or it cannot be served.
    """
    device = scratch / "nxt" if os.name == "posix" else None
    bodies: list[Body] = []

    def change(body: Body) -> None:
        settings.change(body)
        bodies.append(body)

    serving = partial(
        serve,
        clock=SystemClock(),
        tcp=_ANY_PORT,
        tcp_raw=_ANY_PORT,
        pty=device,
        world=settings.world,
        seed=settings.seed,
        profile=settings.profile,
        change=change,
    )
    with served_in_thread(serving) as served:
        tcp, raw = served.urls[:2]
        yield ServedMock(served.name, tcp, _address(tcp), _address(raw), device, bodies[0])


def _address(url: str) -> tuple[str, int]:
    return parse_address(url.partition(":")[2])
