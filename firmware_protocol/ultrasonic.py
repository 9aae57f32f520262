"""The ultrasonic sensor: its registers, its commands, and the requests that read and write them.

The port needs `SensorType.LOW_SPEED_9V`; leave 10 to 15 ms between transactions.
Source: LEGO Mindstorms NXT hardware developer kit, appendix 7 (ultrasonic sensor I2C protocol).
"""

from __future__ import annotations

from enum import IntEnum
from typing import Final

from firmware_protocol.commands.lowspeed import LowSpeedWrite

ADDRESS: Final = 0x02
"""The sensor's address as the first byte of a transaction; seven-bit address 1."""

VERSION: Final = b"V1.0\0\0\0\0"
PRODUCT: Final = b"LEGO\0\0\0\0"
KIND: Final = b"Sonar\0\0\0"
UNITS: Final = b"10E-2m\0"

NO_ECHO: Final = 255
"""The measurement when nothing came back."""
ECHO_COUNT: Final = 8
"""Echoes that a single shot can report; continuous measurement fills only the first."""


class UltrasonicRegister(IntEnum):
    """The first byte of each of the sensor's values; distances are in cm."""

    VERSION = 0x00
    PRODUCT = 0x08
    KIND = 0x10
    FACTORY_ZERO = 0x11
    FACTORY_SCALE_FACTOR = 0x12
    FACTORY_SCALE_DIVISOR = 0x13
    UNITS = 0x14
    CONTINUOUS_INTERVAL = 0x40
    COMMAND = 0x41
    MEASUREMENT = 0x42
    ACTUAL_ZERO = 0x50
    ACTUAL_SCALE_FACTOR = 0x51
    ACTUAL_SCALE_DIVISOR = 0x52


class UltrasonicCommand(IntEnum):
    """Commands to the sensor; it wakes up measuring continuously."""

    OFF = 0x00
    SINGLE_SHOT = 0x01
    CONTINUOUS = 0x02
    EVENT_CAPTURE = 0x03
    WARM_RESET = 0x04


FACTORY_VALUES: Final = {
    UltrasonicRegister.FACTORY_ZERO: 0x00,
    UltrasonicRegister.FACTORY_SCALE_FACTOR: 0x01,
    UltrasonicRegister.FACTORY_SCALE_DIVISOR: 0x0E,
    UltrasonicRegister.CONTINUOUS_INTERVAL: 0x01,
    UltrasonicRegister.COMMAND: UltrasonicCommand.CONTINUOUS,
}


def read_register(port: int, register: int, length: int = 1) -> LowSpeedWrite:
    """The request that asks for a value; fetch it with `LowSpeedRead` once the transaction is done.

    Args:
        port: the sensor port, 0 to 3 (`InputPort`).
        register: where the value starts.
        length: its number of bytes, at most 16.
    """
    return LowSpeedWrite.of(port, bytes((ADDRESS, register)), length)


def write_register(port: int, register: int, value: int) -> LowSpeedWrite:
    """The request that sets a one-byte value.

    Args:
        port: the sensor port, 0 to 3 (`InputPort`).
        register: where to write.
        value: the byte.
    """
    return LowSpeedWrite.of(port, bytes((ADDRESS, register, value)), 0)
