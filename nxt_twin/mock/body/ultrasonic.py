"""The ultrasonic sensor: an I2C device with registers, fed with 9 V.

Source: LEGO Mindstorms NXT hardware developer kit, appendix 7; the ping's duration is an estimate.
"""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import SensorType
from firmware_protocol.ultrasonic import (
    ADDRESS,
    ECHO_COUNT,
    FACTORY_VALUES,
    KIND,
    NO_ECHO,
    PRODUCT,
    UNITS,
    VERSION,
    UltrasonicCommand,
    UltrasonicRegister,
)
from nxt_twin.mock.body.course import SensorView
from nxt_twin.mock.body.sensor import OPEN_READING, Sensor

PING_S: Final = 0.04
_MEMORY_SIZE: Final = 0x100
_MEASUREMENTS: Final = slice(UltrasonicRegister.MEASUREMENT, UltrasonicRegister.MEASUREMENT + ECHO_COUNT)
_WRITABLE: Final = frozenset(
    {
        UltrasonicRegister.CONTINUOUS_INTERVAL,
        UltrasonicRegister.COMMAND,
        UltrasonicRegister.ACTUAL_ZERO,
        UltrasonicRegister.ACTUAL_SCALE_FACTOR,
        UltrasonicRegister.ACTUAL_SCALE_DIVISOR,
    }
)


@final
class UltrasonicBody(Sensor):
    """The ultrasonic sensor.

    Args:
        distance_cm: the echo's distance over time; 255 is no echo.

    Attributes:
        acknowledging: False is a fault: it does not acknowledge its address.
        answering: False is a fault: it acknowledges, but sends nothing.
    """

    def __init__(self, distance_cm: SensorView) -> None:
        self.distance_cm: SensorView = distance_cm
        self.acknowledging = True
        self.answering = True
        self._powered = False
        self._pointer = 0
        self._ping_due_s: float | None = 0.0
        self._memory = bytearray(_MEMORY_SIZE)
        self._reset()

    @property
    def pinging(self) -> bool:
        """Whether it sends pings by itself, which others may hear."""
        return self._powered and self._ping_due_s is not None

    def _reset(self) -> None:
        self._memory[:] = bytes(_MEMORY_SIZE)
        self._memory[: len(VERSION)] = VERSION
        self._put(UltrasonicRegister.PRODUCT, PRODUCT)
        self._put(UltrasonicRegister.UNITS, UNITS)
        for register, value in FACTORY_VALUES.items():
            self._memory[register] = value
        factory = self._memory[UltrasonicRegister.FACTORY_ZERO : UltrasonicRegister.FACTORY_ZERO + 3]
        self._put(UltrasonicRegister.ACTUAL_ZERO, bytes(factory))
        self._memory[_MEASUREMENTS] = bytes((NO_ECHO,)) * ECHO_COUNT

    def _put(self, register: int, data: bytes) -> None:
        self._memory[register : register + len(data)] = data

    def reading(self, time_s: float) -> int:
        """The converter sees an open line."""
        del time_s
        return OPEN_READING

    def set_type(self, sensor_type: int) -> None:
        """Feed it, or cut its power, after which it wakes up as new."""
        powered = sensor_type == SensorType.LOW_SPEED_9V
        if powered and not self._powered:
            self._reset()
            self._ping_due_s = 0.0
        self._powered = powered

    def i2c_write(self, data: bytes, time_s: float) -> bool:
        """A register to read from, and bytes to write there."""
        if not (self._powered and self.acknowledging) or data[:1] != bytes((ADDRESS,)):
            return False
        if len(data) > 1:
            self._pointer = data[1]
        for offset, value in enumerate(data[2:]):
            self._set_register((self._pointer + offset) % _MEMORY_SIZE, value, time_s)
        return True

    def _set_register(self, register: int, value: int, time_s: float) -> None:
        if register not in _WRITABLE:
            return
        self._measure_if_due(time_s)
        self._memory[register] = value
        if register != UltrasonicRegister.COMMAND:
            return
        if value == UltrasonicCommand.WARM_RESET:
            self._reset()
        measuring = self._memory[UltrasonicRegister.COMMAND] in (
            UltrasonicCommand.SINGLE_SHOT,
            UltrasonicCommand.CONTINUOUS,
        )
        self._ping_due_s = time_s + PING_S if measuring else None

    def i2c_read(self, length: int, time_s: float) -> bytes | None:
        """Registers from where the last write pointed; the sensor's kind is read from its first one only."""
        if not (self._powered and self.answering):
            return None
        self._measure_if_due(time_s)
        if self._pointer == UltrasonicRegister.KIND:
            return KIND[:length].ljust(length, b"\0")
        memory = bytes(self._memory)
        return (memory + memory)[self._pointer : self._pointer + length]

    def _measure_if_due(self, time_s: float) -> None:
        if self._ping_due_s is None or time_s < self._ping_due_s:
            return
        distance = min(max(round(self.distance_cm.at(time_s)), 0), NO_ECHO)
        single = self._memory[UltrasonicRegister.COMMAND] == UltrasonicCommand.SINGLE_SHOT
        self._memory[UltrasonicRegister.MEASUREMENT] = distance
        if single:
            self._memory[UltrasonicRegister.MEASUREMENT + 1 : _MEASUREMENTS.stop] = bytes((NO_ECHO,)) * (
                ECHO_COUNT - 1
            )
        self._ping_due_s = None if single else time_s + PING_S
