"""Runs a firmware by a clock: as many ticks as time has passed, however late somebody comes to ask."""

from __future__ import annotations

from typing import Final, final

from nxt_twin.brick.clock import Clock
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware, Power
from nxt_twin.mock.firmware.hardware import TICK_S
from nxt_twin.mock.serve.line import Line
from nxt_twin.mock.serve.profile import Profile

_ROUNDING_S: Final = 1e-9


@final
class Host:
    """A running brick and the lines to it. Not for several threads at once.

    Args:
        firmware: the brick.
        clock: what its ticks follow; with a `VirtualClock`, time passes as fast as the machine can.
    """

    def __init__(self, firmware: Firmware, clock: Clock) -> None:
        self.firmware = firmware
        self.clock = clock
        self._known: list[Line] = []
        self._lines: dict[Transport, Line] = {}
        self._start_s = clock.now_s() - firmware.ticks * TICK_S

    @property
    def running(self) -> bool:
        """Whether the brick is still on and runs its own firmware."""
        return self.firmware.power is Power.ON

    def connect(self, transport: Transport, profile: Profile, seed: int = 0) -> Line:
        """A line to the brick, to be taken when there is somebody at its other end."""
        line = Line(self.firmware, transport, profile, seed)
        self._known.append(line)
        return line

    def take(self, line: Line) -> bool:
        """Put a line in use; False while another one of its transport is."""
        return self._lines.setdefault(line.transport, line) is line

    def release(self, line: Line) -> None:
        """Put a line out of use."""
        if self._lines.get(line.transport) is line:
            del self._lines[line.transport]

    def restart(self, firmware: Firmware) -> None:
        """Run another firmware from now on: the brick was switched on again."""
        self.firmware = firmware
        self._start_s = self.clock.now_s() - firmware.ticks * TICK_S
        for line in self._known:
            line.reset()
            line.firmware = firmware

    @property
    def next_tick_s(self) -> float:
        """When the next tick is due, by the clock."""
        return self._start_s + (self.firmware.ticks + 1) * TICK_S

    def catch_up(self, leaving: int = 0) -> None:
        """Run the ticks that are due, apart from the last few."""
        until_s = self.clock.now_s() + _ROUNDING_S - leaving * TICK_S
        while self.next_tick_s <= until_s:
            self.tick()

    def tick(self) -> None:
        """Run one tick, whatever the clock says."""
        for line in self._lines.values():
            line.deliver()
        self.firmware.tick()
        for line in self._lines.values():
            line.collect()

    def rest(self) -> None:
        """Wait until the next tick is due."""
        self._sleep_until(self.next_tick_s)

    def wait(self, deadline_s: float) -> None:
        """Wait until the next tick or the deadline, whichever is sooner, and run what is due."""
        self._sleep_until(min(self.next_tick_s, deadline_s))
        self.catch_up()

    def _sleep_until(self, time_s: float) -> None:
        pause_s = time_s - self.clock.now_s()
        if pause_s > 0.0:
            self.clock.sleep(pause_s)
