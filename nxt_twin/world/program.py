"""Run somebody's program for a brick in a world, in virtual time, without a change in it.

The program finds the mock brick on USB, as it would find a real one, and its clock is the world's. Whatever library it
uses has to reach USB through pyusb, as nxt-python does.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, final
from unittest.mock import patch

from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import PROFILES
from nxt_twin.mock.serve.program import run_script
from nxt_twin.mock.serve.usb import MockUsbBackend, ServedUsbDevice
from nxt_twin.world.arena import Arena

_LOOK_S: Final = 5e-6
"""What a look at the clock costs: a program that only looks until it is late enough would never end."""

ProgramEnding = Literal["done", "failed", "out of time"]


class TimeIsUp(BaseException):
    """The program has had all the time that it was given; no program is to catch it."""


@final
@dataclass(frozen=True)
class Ran:
    """How a program ended.

    Attributes:
        ending: in which way.
        said: what was wrong, in one line; empty if nothing was.
        elapsed_s: how long it ran by its own clock.
    """

    ending: ProgramEnding
    said: str
    elapsed_s: float


@final
class ProgramClock:
    """Time that passes when somebody waits for it, and a little when somebody looks.

    Args:
        limit_s: when it stops.
    """

    def __init__(self, limit_s: float) -> None:
        self._now_s = 0.0
        self._limit_s = limit_s

    def now_s(self) -> float:
        """The time, s."""
        return self._now_s

    def sleep(self, duration_s: float) -> None:
        """Let time pass.

        Raises:
            TimeIsUp: there is no more.
        """
        self._now_s += max(0.0, duration_s)
        if self._now_s > self._limit_s:
            raise TimeIsUp

    def look_s(self) -> float:
        """The time for a program that asks, which takes it a moment."""
        self.sleep(_LOOK_S)
        return self._now_s


def run_program(
    arena: Arena, script: Path, arguments: Sequence[str] = (), *, limit_s: float = 600.0, link: str = "usb"
) -> Ran:
    """Run a program until it ends; the brick and its world go on to where its clock then is.

    Args:
        arena: the robot in its scene.
        script: a Python file that drives a brick on USB.
        arguments: its command line.
        limit_s: how long it may take, by its clock.
        link: delays of the link, by name (`nxt_twin.mock.serve.profile.PROFILES`).
    """
    clock = ProgramClock(limit_s)
    firmware = Firmware(arena.body, arena.setting.world.identity())
    host = Host(firmware, clock)
    bus = MockUsbBackend([ServedUsbDevice(host, profile=PROFILES[link])])
    ending, said = _run(script, arguments, clock, bus)
    host.catch_up()
    return Ran(ending, said, clock.now_s())


def let_pass(arena: Arena, duration_s: float) -> Ran:
    """Let a world go on while nobody drives the robot."""
    for _ in range(round(duration_s / arena.engine.step_s)):
        arena.body.step()
    return Ran("done", "", duration_s)


def _run(
    script: Path, arguments: Sequence[str], clock: ProgramClock, bus: MockUsbBackend
) -> tuple[ProgramEnding, str]:
    with _instead(clock):
        try:
            return run_script(script, arguments, bus)
        except TimeIsUp:
            return "out of time", ""


@contextmanager
def _instead(clock: ProgramClock) -> Iterator[None]:
    """The world's clock in the place of the machine's."""

    def look_ns() -> int:
        return round(clock.look_s() * 1e9)

    began_s = time.time()
    with ExitStack() as stack:
        for name in ("monotonic", "perf_counter"):
            stack.enter_context(patch.object(time, name, clock.look_s))
            stack.enter_context(patch.object(time, f"{name}_ns", look_ns))
        stack.enter_context(patch.object(time, "time", lambda: began_s + clock.look_s()))
        stack.enter_context(patch.object(time, "sleep", clock.sleep))
        yield
