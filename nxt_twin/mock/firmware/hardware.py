"""The hardware round the firmware: motors, encoders, sensor sockets, battery."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

TICK_S = 0.001
"""The scheduler's period, s."""


class Hardware(Protocol):
    """The seam between firmware and body; ports count from 0."""

    def step(self) -> None:
        """Let one tick of physics pass."""
        ...

    def tacho_counts(self) -> Sequence[int]:
        """The three encoders' counts since power-on, one a degree of the output hub."""
        ...

    def set_motor(self, port: int, speed: int, *, brake: bool) -> None:
        """Set a motor's bridge.

        Args:
            port: 0 to 2.
            speed: -128 to 127; beyond ±100 the pulse width saturates.
            brake: short the winding in the off phase of the pulses, and at speed 0; else leave it open.
        """
        ...

    def analog(self, port: int) -> int:
        """A socket's voltage now, as a 10-bit reading; 1023 where nothing pulls down."""
        ...

    def set_sensor_type(self, port: int, sensor_type: int) -> None:
        """Feed and light the socket as the sensor type needs it."""
        ...

    def i2c_write(self, port: int, data: bytes) -> bool:
        """Send bytes, address first; False if nobody acknowledges."""
        ...

    def i2c_read(self, port: int, length: int) -> bytes | None:
        """Read from the device addressed last, which was told where by the write; None if it stays silent."""
        ...

    def battery_v(self) -> float:
        """The voltage at the battery's terminals, V."""
        ...
