"""What a round trip costs above the bare link: ours and nxt-python's, over the same link and peer in one run.

A round is what a control loop polls: three motors, four sensors, the battery. Rounds of the bare link, ours and
nxt-python's take turns. Two times are taken: this thread's share of the processor, of which the median counts,
and the wall's, of which the quickest tenth does, as whatever else the machine does only adds to it.
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
import nxt.brick
import nxt.motor
import nxt.sensor

from benchmarks.brick_peers import EchoLink, echo_on_pty, echo_on_tcp, mock_brick
from firmware_protocol import InputPort, OutputPort, frame
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.links.tcp import open_tcp
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link

AIM: Final = 0.5
ROUNDS: Final = 1800
MOCK_ROUNDS: Final = 150
"""Of the mock in real time, whose round takes 8 ms."""
ROUNDS_A_TURN: Final = 10

_MOTORS: Final = (OutputPort.A, OutputPort.B, OutputPort.C)
_REQUESTS: Final = (
    *(bytes((0x00, 0x06, port)) for port in _MOTORS),
    *(bytes((0x00, 0x07, port)) for port in InputPort),
    b"\x00\x0b",
)


class Walk(NamedTuple):
    """One way to walk a round, and what has to be done before its turn."""

    round: Callable[[], object]
    prepare: Callable[[], object] = lambda: None


class Cost(NamedTuple):
    """Of a round, µs: the median of the processor's time, and of the wall's the quickest tenth and the median."""

    processor_us: float
    wall_us: float
    typical_wall_us: float


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
    lines = ["round of 3 motors, 4 sensors and battery (8 round trips), µs"]
    lines += _lines("no link at all", _on_one_link(EchoLink()))
    lines += _lines("mock in this process", _on_one_link(open_mock_link(VirtualClock()), rounds_a_turn=1))
    with echo_on_tcp() as address, ExitStack() as stack:
        lines += _lines("echo on tcp", _on_one_link(_tcp(address, stack)))
    with echo_on_pty() as device, ExitStack() as stack:
        lines += _lines("echo on pty", _on_one_link(_serial(device, stack)))
    with echo_on_pty() as device:
        lines += _lines("echo on pty, each by its own link", _on_own_links(device))
    with mock_brick() as places:
        lines += [_polling("mock on tcp", _tcp, places.tcp), _polling("mock on pty", _serial, places.pty)]
    return lines


def _polling(name: str, opened: Callable[[str, ExitStack], Link], address: str) -> str:
    """The mock takes a telegram a millisecond, as the firmware does: that is what its link allows."""
    with ExitStack() as stack:
        bare, ours, theirs = _on_one_link(opened(address, stack), rounds=MOCK_ROUNDS)
    allowed_hz, ours_hz, theirs_hz = (1e6 / each.typical_wall_us for each in (bare, ours, theirs))
    return (
        f"{name}, in real time: the bare link allows {allowed_hz:.1f} rounds/s, ours polls at {ours_hz:.1f} "
        f"({100 * ours_hz / allowed_hz:.0f} %), nxt-python at {theirs_hz:.1f}"
    )


def _lines(name: str, costs: Sequence[Cost]) -> list[str]:
    return [
        _line(name, "processor", [each.processor_us for each in costs]),
        _line(name, "wall", [each.wall_us for each in costs]),
    ]


def _line(name: str, kind: str, times_us: Sequence[float]) -> str:
    bare, ours, theirs = times_us
    ratio = (ours - bare) / (theirs - bare)
    verdict = "met" if ratio <= AIM else "MISSED"
    return (
        f"{name}, {kind}: bare {bare:.1f}, ours +{ours - bare:.1f}, nxt-python +{theirs - bare:.1f}; "
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


def _on_one_link(link: Link, *, rounds: int = ROUNDS, rounds_a_turn: int = ROUNDS_A_TURN) -> list[Cost]:
    """A mock in this process takes turns every round, so that it shares the processor's caches with each alike."""

    def bare() -> None:
        for request in _REQUESTS:
            link.send(request)
            link.receive(1.0)

    ours, theirs = Brick(link, SystemClock()), nxt.brick.Brick(LinkAsSocket(link))
    walks = Walk(bare), Walk(_our_round(ours)), Walk(_their_round(theirs))
    return _compare(walks, rounds, rounds_a_turn)


def _on_own_links(device: str) -> list[Cost]:
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

        def set_up(settings: list[object]) -> Callable[[], object]:
            return lambda: termios.tcsetattr(handle, termios.TCSANOW, settings)

        walks = (
            Walk(bare, set_up(as_bare)),
            Walk(_our_round(ours), set_up(as_ours)),
            Walk(_their_round(theirs), set_up(as_theirs)),
        )
        return _compare(walks, ROUNDS, ROUNDS_A_TURN)


def _our_round(brick: Brick) -> Callable[[], object]:
    def ours() -> None:
        for port in _MOTORS:
            brick.motors.read(port)
        for port in InputPort:
            brick.sensors.read(port)
        brick.device.battery_v()

    return ours


def _their_round(brick: nxt.brick.Brick) -> Callable[[], object]:
    def theirs() -> None:
        for port in nxt.motor.Port:
            if port.value < len(_MOTORS):
                brick.get_output_state(port)
        for port in nxt.sensor.Port:
            brick.get_input_values(port)
        brick.get_battery_level()

    return theirs


def _compare(walks: Sequence[Walk], rounds: int, rounds_a_turn: int) -> list[Cost]:
    processor: list[list[float]] = [[] for _ in walks]
    wall: list[list[float]] = [[] for _ in walks]
    for _ in range(rounds // rounds_a_turn):
        for number, walk in enumerate(walks):
            walk.prepare()
            for _ in range(rounds_a_turn):
                wall_s, processor_s = time.perf_counter(), time.thread_time()
                walk.round()
                processor[number].append(time.thread_time() - processor_s)
                wall[number].append(time.perf_counter() - wall_s)
    return [
        Cost(
            1e6 * statistics.median(own),
            1e6 * statistics.quantiles(all_, n=10)[0],
            1e6 * statistics.median(all_),
        )
        for own, all_ in zip(processor, wall, strict=True)
    ]


if __name__ == "__main__":
    print("\n".join(report()))
