"""What a round trip costs above the bare link: ours and nxt-python's, over the same link and peer in one run.

The peer answers at once with fixed replies. A round is what a control loop polls: three motors, four sensors,
the battery. Rounds of the bare link, ours and nxt-python's take turns, and the quickest of each counts: what
else the machine does only adds to them.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Final

import nxt.backend.devfile
import nxt.brick
import nxt.motor
import nxt.sensor

from firmware_protocol import FrameSplitter, InputPort, OutputPort, frame
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.links.tcp import open_tcp

AIM: Final = 0.5
ROUNDS: Final = 1500

_MOTORS: Final = (OutputPort.A, OutputPort.B, OutputPort.C)
_REQUESTS: Final = (
    *(bytes((0x00, 0x06, port)) for port in _MOTORS),
    *(bytes((0x00, 0x07, port)) for port in InputPort),
    b"\x00\x0b",
)
Round = Callable[[], object]


class LinkAsSocket:
    """Any link, as nxt-python wants it."""

    bsize = 60
    type = "usb"

    def __init__(self, link: Link) -> None:
        self._link = link
        self.send = link.send

    def recv(self) -> bytes:
        return self._link.receive(1.0)

    def close(self) -> None:
        self._link.close()


class EchoLink:
    """A link that costs nothing: the reply is there at once."""

    def __init__(self) -> None:
        self._reply = b""

    def send(self, telegram: bytes) -> None:
        self._reply = reply_to(telegram)

    def receive(self, timeout_s: float) -> bytes:
        del timeout_s
        return self._reply

    def close(self) -> None:
        self._reply = b""

    def describe(self) -> str:
        return "echo"


def reply_to(telegram: bytes) -> bytes:
    if telegram[1] == 0x06:
        return b"\x02\x06\x00" + telegram[2:3] + bytes(21)
    if telegram[1] == 0x07:
        return b"\x02\x07\x00" + telegram[2:3] + b"\x01" + bytes(11)
    return b"\x02\x0b\x00\x10\x20"


def report() -> list[str]:
    """One line a link: the cost of a round, and the ratio of the overheads."""
    lines = ["round trip of a polled set (3 motors, 4 sensors, battery), µs a round; quickest of many rounds"]
    lines.append(_line("no link at all", *_on_one_link(EchoLink())))
    with _peer_on_tcp() as link:
        lines.append(_line("tcp, both over our link", *_on_one_link(link)))
    lines.append(_line("pty, each over its own link", *_on_own_links()))
    return lines


def _line(name: str, bare_s: float, ours_s: float, theirs_s: float) -> str:
    ratio = (ours_s - bare_s) / (theirs_s - bare_s)
    bare, ours, theirs = (1e6 * each for each in (bare_s, ours_s, theirs_s))
    verdict = "met" if ratio <= AIM else "MISSED"
    return (
        f"  {name}: bare {bare:.1f}, ours +{ours - bare:.1f}, nxt-python +{theirs - bare:.1f}; "
        f"ratio {ratio:.2f} (aim <= {AIM:g}: {verdict}); {len(_REQUESTS) / ours_s:.0f} requests/s"
    )


def _on_one_link(link: Link) -> tuple[float, float, float]:
    def bare() -> None:
        for request in _REQUESTS:
            link.send(request)
            link.receive(1.0)

    return _compare(
        bare, _our_round(Brick(link, SystemClock())), _their_round(nxt.brick.Brick(LinkAsSocket(link)))
    )


def _on_own_links() -> tuple[float, float, float]:
    """A pty and a peer for each, as the two set a terminal up differently; bare is read and write alone."""
    framed = [frame(request) for request in _REQUESTS]
    with ExitStack() as stack:
        handle = os.open(stack.enter_context(_peer_on_pty()), os.O_RDWR | os.O_NOCTTY)
        stack.callback(os.close, handle)
        ours = stack.enter_context(
            Brick(open_serial(stack.enter_context(_peer_on_pty()), SystemClock()), SystemClock())
        )
        theirs = nxt.backend.devfile.DevFileSock(stack.enter_context(_peer_on_pty())).connect()
        stack.callback(theirs.close)

        def bare() -> None:
            for request in framed:
                os.write(handle, request)
                os.read(handle, 128)

        return _compare(bare, _our_round(ours), _their_round(theirs))


def _our_round(brick: Brick) -> Round:
    def ours() -> None:
        for port in _MOTORS:
            brick.motors.read(port)
        for port in InputPort:
            brick.sensors.read(port)
        brick.device.battery_v()

    return ours


def _their_round(brick: nxt.brick.Brick) -> Round:
    def theirs() -> None:
        for port in nxt.motor.Port:
            if port.value < len(_MOTORS):
                brick.get_output_state(port)
        for port in nxt.sensor.Port:
            brick.get_input_values(port)
        brick.get_battery_level()

    return theirs


def _compare(*rounds: Round) -> tuple[float, ...]:
    quickest = [float("inf")] * len(rounds)
    for _ in range(ROUNDS):
        for number, walk in enumerate(rounds):
            start_s = time.perf_counter()
            walk()
            quickest[number] = min(quickest[number], time.perf_counter() - start_s)
    return tuple(quickest)


@contextmanager
def _peer_on_tcp() -> Iterator[Link]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = open_tcp(f"127.0.0.1:{server.getsockname()[1]}", SystemClock())
        far, _ = server.accept()
    with far, _peer(far.fileno()):
        far.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        yield link
        link.close()


@contextmanager
def _peer_on_pty() -> Iterator[str]:
    controller, terminal = os.openpty()
    tty.setraw(terminal)
    try:
        with _peer(controller):
            yield os.ttyname(terminal)
    finally:
        os.close(controller)
        os.close(terminal)


@contextmanager
def _peer(handle: int) -> Iterator[None]:
    """The peer is a process of its own, or it would take its share of this one's time."""
    with subprocess.Popen([sys.executable, __file__, str(handle)], pass_fds=[handle]) as process:
        try:
            yield
        finally:
            process.kill()


def _serve(handle: int) -> None:
    splitter = FrameSplitter()
    while data := os.read(handle, 4096):
        for telegram in splitter.feed(data):
            os.write(handle, frame(reply_to(telegram)))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        _serve(int(sys.argv[1]))
    else:
        print("\n".join(report()))
