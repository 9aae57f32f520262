"""From a 10-bit reading to the normalised one, by sensor type; integer arithmetic throughout.

Source: LEGO NXT firmware 1.29, c_input.c and c_input.h.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final, NamedTuple

from firmware_protocol import SensorType

FULL_SCALE: Final = 1023


class Range(NamedTuple):
    """The part of the converter's range that a sensor uses: reading at zero, and its width in percent."""

    zero: int
    percent: int


INVERTED_RANGES: Final = {
    SensorType.REFLECTION: Range(476, 41),
    SensorType.LIGHT_ACTIVE: Range(200, 68),
    SensorType.LIGHT_INACTIVE: Range(200, 68),
    SensorType.SOUND_DB: Range(162, 83),
    SensorType.SOUND_DBA: Range(162, 83),
}
"""Sensors whose voltage falls with what they measure."""

DIRECT_TYPES: Final = frozenset({SensorType.SWITCH, SensorType.ANGLE})

_THERMISTOR: Final = (
    (261, 808), (325, 602), (389, 476), (453, 382), (517, 300), (581, 228),
    (645, 162), (709, 94), (773, 24), (837, -54), (901, -150), (928, -200),
)  # fmt: skip
"""Readings of LEGO's temperature sensor and its tenths of a degree Celsius; between them a line."""


def scaled(raw: int, span: Range) -> int:
    """The reading stretched from a part of the range to the whole of it."""
    if span.percent == 0:
        return 0
    return min(FULL_SCALE, max(0, raw - span.zero) * 100 // span.percent)


def normalised(sensor_type: int, raw: int, custom: Range) -> int | None:
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
        return (_thermistor_tenths(raw) + 200) * FULL_SCALE // 900
    if sensor_type == SensorType.CUSTOM:
        return scaled(raw, custom)
    return None


def _thermistor_tenths(raw: int) -> int:
    reading = min(max(raw, 290), 928)
    for (low, warm), (high, cold) in pairwise(_THERMISTOR):
        if reading <= high:
            return warm + (cold - warm) * (reading - low) // (high - low)
    return _THERMISTOR[-1][1]
