"""Cost of a round trip above the bare link: ours and nxt-python's, over one link and peer in one run.

A round is what a control loop polls: three motors, four sensors, the battery. Short blocks of rounds of the
bare link, ours and nxt-python's take turns. Each turn gives two differences to the bare link at that moment,
so other load and the clock rate strike all three alike. The median over all turns counts. Two times are
taken: this thread's share of the processor, and the wall's.
"""

from __future__ import annotations

import os
import statistics
import termios
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Final, NamedTuple

import nxt.backend.devfile
import nxt.backend.usb
import nxt.brick
import nxt.motor
import nxt.sensor

from benchmarks.brick_peers import EchoLink, echo_on_pty, echo_on_tcp, mock_brick
from benchmarks.brick_usb_echo import UsbEchoBackend
from firmware_protocol import InputPort, OutputPort, frame
from firmware_protocol.usb import ENDPOINT_IN, ENDPOINT_OUT, PACKET_SIZE
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.links.tcp import open_tcp
from nxt_twin.brick.links.usb import open_usb
from nxt_twin.brick.links.usb_devices import find_bricks
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link

AIM: Final = 0.5
TURNS: Final = 600
TURNS_OF_A_MOCK: Final = 60
"""In real time, where a round takes 8 ms."""
ROUNDS_A_TURN: Final = 4

_MOTORS: Final = (OutputPort.A, OutputPort.B, OutputPort.C)
_SENSORS: Final = tuple(InputPort)
_THEIR_MOTORS: Final = tuple(nxt.motor.Port)[: len(_MOTORS)]
_THEIR_SENSORS: Final = tuple(nxt.sensor.Port)
_REQUESTS: Final = (
    *(bytes((0x00, 0x06, port)) for port in _MOTORS),
    *(bytes((0x00, 0x07, port)) for port in _SENSORS),
    b"\x00\x0b",
)


class Walk(NamedTuple):
    """One way to walk a round, and what has to be done before its turn."""

    round: Callable[[], object]
    prepare: Callable[[], object] = lambda: None


class Times(NamedTuple):
    """Of a round, µs, turn by turn: the bare link's, and how much longer ours and nxt-python's took.

    Attributes:
        bare_us: of the bare link.
        ours_us: ours, above it.
        theirs_us: nxt-python's, above it.
    """

    bare_us: list[float]
    ours_us: list[float]
    theirs_us: list[float]


class Compared(NamedTuple):
    """The processor's times and the wall's."""

    processor: Times
    wall: Times


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


def report() -> list[str]:
    """The cost of a round and the ratio of the overheads, by processor and by wall; and the rate of polling."""
    lines = [
        "round of 3 motors, 4 sensors and battery (8 round trips), µs; ours and nxt-python above the bare link"
    ]
    lines += _lines("no link at all", _on_one_link(EchoLink()))
    lines += _lines("mock in this process", _on_one_link(open_mock_link(VirtualClock()), rounds_a_turn=1))
    with echo_on_tcp() as address, ExitStack() as stack:
        lines += _lines("echo on tcp", _on_one_link(_tcp(address, stack)))
    with echo_on_pty() as device, ExitStack() as stack:
        lines += _lines("echo on pty", _on_one_link(_serial(device, stack)))
    with echo_on_pty() as device:
        lines += _lines("echo on pty, each by its own link", _on_own_terminals(device))
    lines += _lines("pyusb without a wire, each by its own link", _on_usb())
    with mock_brick() as places:
        with ExitStack() as stack:
            on_tcp = _on_one_link(_tcp(places.tcp, stack), turns=TURNS_OF_A_MOCK)
        with ExitStack() as stack:
            on_pty = _on_one_link(_serial(places.pty, stack), turns=TURNS_OF_A_MOCK)
        on_own = _on_own_terminals(places.pty, turns=TURNS_OF_A_MOCK)
    for name, compared in ("on tcp", on_tcp), ("on pty", on_pty), ("on pty, each by its own link", on_own):
        mock = f"mock process {name}"
        lines += [_line(mock, "processor", compared.processor), _polling(mock, compared.wall)]
    return lines


def _polling(name: str, wall: Times) -> str:
    """The mock takes a telegram a millisecond, as the firmware does: that is what its link allows."""
    bare_us = statistics.median(wall.bare_us)
    ours_us, theirs_us = statistics.median(wall.ours_us), statistics.median(wall.theirs_us)
    allowed_hz, ours_hz, theirs_hz = (1e6 / (bare_us + more) for more in (0.0, ours_us, theirs_us))
    return (
        f"{name}, wall: bare {bare_us:.0f}, ours {ours_us:+.0f}, nxt-python {theirs_us:+.0f}, all within the brick's "
        f"ms a telegram; bare {allowed_hz:.1f} rounds/s, ours {ours_hz:.1f} ({100 * ours_hz / allowed_hz:.0f} %), "
        f"nxt-python {theirs_hz:.1f}"
    )


def _lines(name: str, compared: Compared) -> list[str]:
    return [_line(name, "processor", compared.processor), _line(name, "wall", compared.wall)]


def _line(name: str, kind: str, times: Times) -> str:
    bare, ours, theirs = (statistics.median(each) for each in times)
    ratio = ours / theirs
    verdict = "met" if ratio <= AIM else "MISSED"
    return (
        f"{name}, {kind}: bare {bare:.1f}, ours +{ours:.1f}, nxt-python +{theirs:.1f}; "
        f"ratio {ratio:.2f} (aim <= {AIM:g}: {verdict})"
    )


def _tcp(address: str, stack: ExitStack) -> Link:
    link = open_tcp(address, SystemClock())
    stack.callback(link.close)
    return link


def _serial(device: str, stack: ExitStack) -> Link:
    link = open_serial(device, SystemClock())
    stack.callback(link.close)
    return link


def _on_one_link(link: Link, *, turns: int = TURNS, rounds_a_turn: int = ROUNDS_A_TURN) -> Compared:
    """A mock in this process takes turns every round, so that it shares the processor's caches with each alike."""

    def bare() -> None:
        for request in _REQUESTS:
            link.send(request)
            link.receive(1.0)

    ours, theirs = Brick(link, SystemClock()), nxt.brick.Brick(LinkAsSocket(link))
    return _compare((Walk(bare), Walk(_our_round(ours)), Walk(_their_round(theirs))), turns, rounds_a_turn)


def _on_own_terminals(device: str, *, turns: int = TURNS) -> Compared:
    """On one terminal, which each sets up in its way before its turn; bare is read and write alone."""
    framed = [frame(request) for request in _REQUESTS]
    with ExitStack() as stack:
        handle = os.open(device, os.O_RDWR | os.O_NOCTTY)
        stack.callback(os.close, handle)

        def bare() -> None:
            for request in framed:
                os.write(handle, request)
                os.read(handle, 128)

        as_bare = termios.tcgetattr(handle)
        ours = stack.enter_context(Brick(open_serial(device, SystemClock()), SystemClock()))
        as_ours = termios.tcgetattr(handle)
        theirs = nxt.backend.devfile.DevFileSock(device).connect()
        stack.callback(theirs.close)
        as_theirs = termios.tcgetattr(handle)

        def set_up(settings: list[int | list[bytes | int]]) -> Callable[[], object]:
            return lambda: termios.tcsetattr(handle, termios.TCSANOW, settings)

        walks = (
            Walk(bare, set_up(as_bare)),
            Walk(_our_round(ours), set_up(as_ours)),
            Walk(_their_round(theirs), set_up(as_theirs)),
        )
        return _compare(walks, turns, ROUNDS_A_TURN)


def _on_usb() -> Compared:
    """Bare is pyusb's own write and read."""
    backend = UsbEchoBackend()
    device = find_bricks(backend)[0].device

    def bare() -> None:
        for request in _REQUESTS:
            device.write(ENDPOINT_OUT, request, 1000)
            device.read(ENDPOINT_IN, PACKET_SIZE, 1000).tobytes()

    theirs = nxt.backend.usb.USBSock(device).connect()
    with Brick(open_usb("", SystemClock(), backend=backend), SystemClock()) as ours:
        return _compare(
            (Walk(bare), Walk(_our_round(ours)), Walk(_their_round(theirs))), TURNS, ROUNDS_A_TURN
        )


def _our_round(brick: Brick) -> Callable[[], object]:
    def ours() -> None:
        for motor in _MOTORS:
            brick.motors.read(motor)
        for sensor in _SENSORS:
            brick.sensors.read(sensor)
        brick.device.battery_v()

    return ours


def _their_round(brick: nxt.brick.Brick) -> Callable[[], object]:
    def theirs() -> None:
        for motor in _THEIR_MOTORS:
            brick.get_output_state(motor)
        for sensor in _THEIR_SENSORS:
            brick.get_input_values(sensor)
        brick.get_battery_level()

    return theirs


def _compare(walks: Sequence[Walk], turns: int, rounds_a_turn: int) -> Compared:
    """Bare, ours, theirs; every other turn backwards, so that none gains by what came before it."""
    processor, wall = Times([], [], []), Times([], [], [])
    for turn in range(turns):
        taken = [(0.0, 0.0)] * len(walks)
        for number in range(len(walks)) if turn % 2 else reversed(range(len(walks))):
            taken[number] = _block(walks[number], rounds_a_turn)
        for times, of_this in zip((processor, wall), zip(*taken, strict=True), strict=True):
            bare, ours, theirs = of_this
            times.bare_us.append(bare)
            times.ours_us.append(ours - bare)
            times.theirs_us.append(theirs - bare)
    return Compared(processor, wall)


def _block(walk: Walk, rounds: int) -> tuple[float, float]:
    """The processor's time of a round and the wall's, µs; the quickest of the block's counts."""
    walk.prepare()
    processor, wall = [], []
    for _ in range(rounds):
        wall_s, processor_s = time.perf_counter(), time.thread_time()
        walk.round()
        processor.append(time.thread_time() - processor_s)
        wall.append(time.perf_counter() - wall_s)
    return 1e6 * min(processor), 1e6 * min(wall)


if __name__ == "__main__":
    print("\n".join(report()))
