"""From a raw 10-bit reading to the percent that the brick shows, by the firmware's integer arithmetic.

Source: LEGO NXT firmware 1.29, c_input.c and c_input.h: light 200/68, sound 162/83, both falling.
"""

from __future__ import annotations

from typing import Literal

_FULL = 1023
_RANGES = {"light": (200, 68), "sound": (162, 83)}


def firmware_percent(raw: int, sensor: Literal["light", "sound"]) -> int:
    """The percent 0 to 100 of a raw reading 0 to 1023; bright and loud are high."""
    zero, width_pct = _RANGES[sensor]
    stretched = min(_FULL, max(0, raw - zero) * 100 // width_pct)
    return (_FULL - stretched) * 100 // _FULL
