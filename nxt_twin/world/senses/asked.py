"""A sensor that is left alone until a program has said what it is."""

from __future__ import annotations

from typing import final

from firmware_protocol import SensorType
from nxt_twin.mock.body.sensor import OPEN_READING, Sensor


@final
class Asked(Sensor):
    """Measures only while its port has a type: without one the firmware shows no reading, so that none is needed.

    Args:
        sensor: what is plugged in.
    """

    def __init__(self, sensor: Sensor) -> None:
        self.sensor = sensor
        self._asked = False

    def reading(self, time_s: float) -> int:
        """The sensor's; that of an open socket while nobody asks."""
        return self.sensor.reading(time_s) if self._asked else OPEN_READING

    def set_type(self, sensor_type: int) -> None:
        """Take note whether there is one, and hand it on."""
        self._asked = sensor_type != SensorType.NO_SENSOR
        self.sensor.set_type(sensor_type)

    def i2c_write(self, data: bytes, time_s: float) -> bool:
        """The sensor's."""
        return self.sensor.i2c_write(data, time_s)

    def i2c_read(self, length: int, time_s: float) -> bytes | None:
        """The sensor's."""
        return self.sensor.i2c_read(length, time_s)
