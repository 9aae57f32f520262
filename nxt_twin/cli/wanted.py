"""What commands that talk to a brick ask for alike: which brick, which motors and sensors, and leave to move."""

from __future__ import annotations

import re
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, cast

import typer

from nxt_twin.brick.clock import Clock
from nxt_twin.brick.discovery import default_ways, search_ways
from nxt_twin.brick.errors import LinkRefusedError, Refusal
from nxt_twin.cli.output import fail
from nxt_twin.recording.columns import PORTS, Port, SensorSlot

if TYPE_CHECKING:
    # Brings in the filters, which nobody needs who only polls.
    from nxt_twin.twin.sensor_twin import PortSensor

NOTHING: Final = "none"
_KINDS: Final = ("touch", "sound", "light", "ultrasonic")
_LOOPBACK: Final = re.compile(r"(127(\.\d+){3}|localhost|\[::1\]):")
_POLITE: Final = (
    "SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGALRM", "SIGVTALRM", "SIGPROF", "SIGXCPU",
    "SIGBREAK",
)  # fmt: skip
_SLOTS: Final = ("1", "2", "3", "4")


def wanted_ports(text: str) -> tuple[Port, ...]:
    """The motors that a text such as ``ab`` names, each once.

    Raises:
        typer.BadParameter: it names none, or something else.
    """
    ports = dict.fromkeys(text.lower().replace(",", ""))
    if not ports or not ports.keys() <= set(PORTS):
        raise typer.BadParameter(
            f"'{text}' names no motors: write letters of {''.join(PORTS)}, such as ab", param_hint="--ports"
        )
    return cast("tuple[Port, ...]", tuple(ports))


def wanted_sensors(text: str) -> Mapping[SensorSlot, PortSensor]:
    """The sensors that a text such as ``1:touch,4:ultrasonic`` names; none for ``none``.

    Raises:
        typer.BadParameter: it is not of that form.
    """
    slots: dict[SensorSlot, PortSensor] = {}
    for part in [] if text in ("", NOTHING) else text.split(","):
        slot, _, kind = part.strip().partition(":")
        if slot not in _SLOTS or kind not in _KINDS:
            what = f"'{part}' is not SLOT:KIND, such as 1:touch; kinds are {', '.join(_KINDS)}"
            raise typer.BadParameter(what, param_hint="--sensors")
        slots[cast("SensorSlot", int(slot))] = cast("PortSensor", kind)
    return slots


def chosen_url(url: str | None, clock: Clock) -> str:
    """The URL that was given, or that of the first brick that a search finds.

    Raises:
        LinkRefusedError: no brick was found.
    """
    if url is not None:
        return url
    for report in search_ways(clock, default_ways()):
        for brick in report.bricks:
            return brick.url
    mend = "switch it on, or name mock: for one made of software"
    raise LinkRefusedError("no brick was found", cause=Refusal.NOT_FOUND, mend=mend)


def get_leave(url: str, ports: tuple[Port, ...], *, yes: bool) -> None:
    """Ask before motors of a real brick turn; one that this machine itself serves over TCP is made of software.

    Raises:
        typer.BadParameter: nobody is there to be asked.
        typer.Exit: the answer is no.
    """
    scheme, _, address = url.partition(":")
    if yes or scheme == "mock" or (scheme == "tcp" and _LOOPBACK.match(address)):
        return
    motors = ", ".join(port.upper() for port in ports)
    if not sys.stdin.isatty():
        raise typer.BadParameter(f"motors {motors} will turn: allow this with --yes", param_hint="--yes")
    if not typer.confirm(f"Motors {motors} of {url} will turn both ways. Is nothing in their way?"):
        fail("you said no, so nothing was done")
        raise typer.Exit(1)


@contextmanager
def tidy_end() -> Iterator[None]:
    """Whoever ends the program, and however politely: an interrupt comes of it, so that the motors are let go.

    A shell starts background jobs with the interrupt ignored. A terminate signal, a closed terminal, a timer or a limit
    would end Python at once.
    """
    numbers = [getattr(signal, name) for name in _POLITE if hasattr(signal, name)]
    before = {number: signal.signal(number, signal.default_int_handler) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
