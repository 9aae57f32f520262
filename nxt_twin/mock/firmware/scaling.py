"""From a 10-bit reading to the normalised one, by sensor type; integer arithmetic throughout.

Source: LEGO NXT firmware 1.29, c_input.c and c_input.h.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from firmware_protocol import SensorType
from nxt_twin.mock.firmware.integers import s16, u16, u32

FULL_SCALE: Final = 1023


class ConverterSpan(NamedTuple):
    """The part of the converter's range that a sensor uses: reading at zero, and its width in percent."""

    zero: int
    percent: int


INVERTED_RANGES: Final = {
    SensorType.REFLECTION: ConverterSpan(476, 41),
    SensorType.LIGHT_ACTIVE: ConverterSpan(200, 68),
    SensorType.LIGHT_INACTIVE: ConverterSpan(200, 68),
    SensorType.SOUND_DB: ConverterSpan(162, 83),
    SensorType.SOUND_DBA: ConverterSpan(162, 83),
}
"""Sensors whose voltage falls with what they measure."""

DIRECT_TYPES: Final = frozenset({SensorType.SWITCH, SensorType.ANGLE})

_THERMISTOR_FIRST: Final = 290
_THERMISTOR_LAST: Final = 928
_THERMISTOR_SHIFT: Final = 48
_THERMISTOR: Final = (
    195_856_762_719_738_784, -822_478_326_197_838, 2_573_629_857_807, -6_686_663_252, 9_261_399, -5_425,
)  # fmt: skip
"""LEGO's temperature sensor: tenths of a degree Celsius as a polynomial of the reading, in 2⁻⁴⁸, constant first.

Source: c_input.c cInputTempConv. LEGO's own builds hold a table instead, nowhere more than 0.4 K from it.
"""


def scaled(raw: int, span: ConverterSpan) -> int:
    """The reading stretched from a part of the range to the whole of it."""
    if span.percent == 0:
        return 0
    return min(FULL_SCALE, max(0, raw - span.zero) * 100 // span.percent)


def normalised(sensor_type: int, raw: int, custom: ConverterSpan) -> int | None:
    """The normalised reading 0 to 1023, or None for a type that does not use the converter.

    Args:
        sensor_type: the port's type.
        raw: the converter's reading.
        custom: the range that a host has set for a custom sensor.
    """
    if sensor_type in DIRECT_TYPES:
        return raw
    if sensor_type in INVERTED_RANGES:
        return FULL_SCALE - scaled(raw, INVERTED_RANGES[SensorType(sensor_type)])
    if sensor_type == SensorType.TEMPERATURE:
        return u16(u16(_thermistor_tenths(raw) + 200) * FULL_SCALE // 900)
    if sensor_type == SensorType.CUSTOM:
        return scaled(raw, custom)
    return None


def fahrenheit_tenths(celsius_tenths: int) -> int:
    """Tenths of a degree Fahrenheit as the firmware reckons them, in unsigned words: wrong below 0 °C."""
    return s16(u32(180 * celsius_tenths) // 100 + 320)


def _thermistor_tenths(raw: int) -> int:
    at = min(max(raw, _THERMISTOR_FIRST), _THERMISTOR_LAST) - _THERMISTOR_FIRST
    value = 0
    for coefficient in reversed(_THERMISTOR):
        value = value * at + coefficient
    return (value + (1 << _THERMISTOR_SHIFT - 1)) >> _THERMISTOR_SHIFT
