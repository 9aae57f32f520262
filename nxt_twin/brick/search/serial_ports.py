"""Bricks behind serial ports that Bluetooth provides; opening another could reset what it leads to."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final, NamedTuple

from serial.tools import list_ports

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import BrickError, Refusal
from nxt_twin.brick.link import Link
from nxt_twin.brick.links.serial_port import open_serial
from nxt_twin.brick.policy import STREAM_POLICY
from nxt_twin.brick.search.finding import FoundBrick, Reason, WayReport, reason_of

_BIND: Final = "pair the brick, then: sudo rfcomm bind 0 ADDRESS 1; on Windows and macOS it has a port then"
_LEADS_TO_A_BRICK: Final = re.compile(r"rfcomm\d|NXT|001653|00:16:53", re.IGNORECASE)


class SerialPort(NamedTuple):
    """A serial port of this machine.

    Attributes:
        device: its name.
        description: what the system says of it.
    """

    device: str
    description: str


def serial_ports() -> tuple[SerialPort, ...]:
    """The serial ports of this machine, those of Bluetooth among them."""
    listed = [SerialPort(port.device, f"{port.description} {port.hwid}") for port in list_ports.comports()]
    bound = [SerialPort(str(path), "Bluetooth") for path in sorted(Path("/dev").glob("rfcomm[0-9]*"))]
    return tuple({port.device: port for port in [*listed, *bound]}.values())


def leads_to_a_brick(port: SerialPort) -> bool:
    """Whether name or description tell that Bluetooth or a brick is behind it."""
    return bool(_LEADS_TO_A_BRICK.search(f"{port.device} {port.description}"))


def look_on_serial_ports(
    clock: Clock,
    *,
    ports: Callable[[], Iterable[SerialPort]] = serial_ports,
    opener: Callable[[str, Clock], Link] = open_serial,
) -> WayReport:
    """The bricks behind serial ports; each is asked for its name.

    Args:
        clock: measures timeouts.
        ports: lists the ports.
        opener: opens one.
    """
    there = tuple(ports())
    likely = [port for port in there if leads_to_a_brick(port)]
    bricks: list[FoundBrick] = []
    reasons: list[Reason] = []
    for port in likely:
        try:
            bricks.append(FoundBrick(f"serial:{port.device}", _name_behind(port, clock, opener)))
        except BrickError as error:
            reasons.append(reason_of(error))
    others = ", ".join(port.device for port in there if port not in likely)
    if others and not bricks:
        what = f"ports that do not look like a brick's were left alone: {others}"
        reasons.append(Reason(what, Refusal.NOT_FOUND, "if one is a brick's, name it: serial:DEVICE"))
    if not bricks and not reasons:
        reasons.append(Reason("there are no serial ports", Refusal.NOT_FOUND, _BIND))
    return WayReport("serial", tuple(bricks), tuple(reasons))


def _name_behind(port: SerialPort, clock: Clock, opener: Callable[[str, Clock], Link]) -> str:
    with Brick(opener(port.device, clock), clock, STREAM_POLICY) as brick:
        return f"{brick.device.info().value.name} on {port.device}"
