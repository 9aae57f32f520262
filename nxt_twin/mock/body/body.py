"""The body as a whole, which the firmware drives and reads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import final

from nxt_twin.mock.body.battery import Battery
from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.mock.body.sensor import Sensor
from nxt_twin.mock.firmware.hardware import TICK_S


@final
class Body:
    """Battery, motors and sensors; the firmware's `Hardware`.

    Args:
        battery: feeds all.
        motors: on ports A, B and C.
        sensors: on ports 1 to 4.

    Attributes:
        followers: called after each tick; what hangs on a motor and has a memory, such as a carriage with play.
    """

    def __init__(self, battery: Battery, motors: MotorBank, sensors: Sequence[Sensor]) -> None:
        self.battery = battery
        self.motors = motors
        self.sensors = list(sensors)
        self.followers: list[Callable[[], None]] = []
        self.time_s = 0.0

    def step(self) -> None:
        """Let one tick of physics pass."""
        current_a = self.motors.step(self.battery.terminal_v, TICK_S)
        self.battery.draw(current_a, TICK_S)
        self.time_s += TICK_S
        for follow in self.followers:
            follow()

    def tacho_counts(self) -> Sequence[int]:
        """The encoders' counts since power-on."""
        return self.motors.counts()

    def set_motor(self, port: int, speed: int, *, brake: bool) -> None:
        """Set a bridge."""
        self.motors.set(port, speed, brake=brake)

    def analog(self, port: int) -> int:
        """A socket's reading."""
        return self.sensors[port].reading(self.time_s)

    def set_sensor_type(self, port: int, sensor_type: int) -> None:
        """Feed and light a socket."""
        self.sensors[port].set_type(sensor_type)

    def i2c_write(self, port: int, data: bytes) -> bool:
        """Send bytes to a socket's device."""
        return self.sensors[port].i2c_write(data, self.time_s)

    def i2c_read(self, port: int, length: int) -> bytes | None:
        """Read from a socket's device."""
        return self.sensors[port].i2c_read(length, self.time_s)

    def battery_v(self) -> float:
        """The voltage at the battery's terminals."""
        return self.battery.terminal_v
