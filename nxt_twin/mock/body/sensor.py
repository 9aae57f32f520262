"""What can be plugged into a sensor socket, seen from the socket's pins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from random import Random
from typing import Final, final

from firmware_protocol import SensorType
from nxt_twin.mock.body.course import SensorView, constant

OPEN_READING: Final = 1023
TOUCH_PRESSED_READING: Final = 183
"""2.2 kΩ in the sensor against the brick's 10 kΩ."""


class Sensor(ABC):
    """Abstract: a sensor."""

    @abstractmethod
    def reading(self, time_s: float) -> int:
        """The converter's reading, 0 to 1023."""

    @abstractmethod
    def set_type(self, sensor_type: int) -> None:
        """The firmware feeds and lights the socket for this type of sensor."""

    @abstractmethod
    def i2c_write(self, data: bytes, time_s: float) -> bool:
        """Take bytes, address first; False for no acknowledgement."""

    @abstractmethod
    def i2c_read(self, length: int, time_s: float) -> bytes | None:
        """Answer a read; None for silence."""


@final
class Touch(Sensor):
    """The touch sensor: a switch.

    Args:
        pressed: 0 or 1 over time.
    """

    def __init__(self, pressed: SensorView | None = None) -> None:
        self.pressed: SensorView = pressed or constant(0.0)

    def reading(self, time_s: float) -> int:
        """Low when pressed."""
        return TOUCH_PRESSED_READING if self.pressed.at(time_s) >= 0.5 else OPEN_READING

    def set_type(self, sensor_type: int) -> None:
        """Nothing changes for a switch."""

    def i2c_write(self, data: bytes, time_s: float) -> bool:
        """Nobody there."""
        del data, time_s
        return False

    def i2c_read(self, length: int, time_s: float) -> bytes | None:
        """Nobody there."""
        del length, time_s
        return None


@final
class Analog(Sensor):
    """A sensor with a voltage: sound, light, or anything else on the converter.

    Args:
        raw: the reading over time, 0 to 1023; falls with loudness and with light.
        lit_raw: the reading with the sensor's lamp on (type light active); None if it makes no difference.
        noise_raw: standard deviation of the reading.
        random: where the noise comes from.
    """

    def __init__(
        self,
        raw: SensorView,
        *,
        lit_raw: SensorView | None = None,
        noise_raw: float = 0.0,
        random: Random | None = None,
    ) -> None:
        self.raw: SensorView = raw
        self.lit_raw: SensorView = lit_raw or raw
        self._noise_raw = noise_raw
        self._random = random or Random(0)  # noqa: S311 - noise, not secrets
        self._lit = False

    def reading(self, time_s: float) -> int:
        """The course's value, with noise."""
        value = (self.lit_raw if self._lit else self.raw).at(time_s)
        if self._noise_raw:
            value += self._random.gauss(0.0, self._noise_raw)
        return min(max(round(value), 0), OPEN_READING)

    def set_type(self, sensor_type: int) -> None:
        """Switch the lamp."""
        self._lit = sensor_type == SensorType.LIGHT_ACTIVE

    def i2c_write(self, data: bytes, time_s: float) -> bool:
        """Nobody there."""
        del data, time_s
        return False

    def i2c_read(self, length: int, time_s: float) -> bytes | None:
        """Nobody there."""
        del length, time_s
        return None


def empty_socket() -> Sensor:
    """Nothing plugged in: the brick's pull-up is all that the converter sees."""
    return Analog(constant(OPEN_READING))
