"""The effect of a command on the motor's bridge, and its time."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from nxt_twin.recording.columns import DRIVE_MODES, DriveMode
from nxt_twin.recording.pulses import PULSE_STEPS

_FADE_S = 0.004
"""A motor that is let go is driven by 1 % less each ms (LEGO NXT firmware 1.29, d_output.c); in steps of so much."""
_FADE_PCT_PER_S = 1000.0

DRIVE, FLOAT, COAST, BRAKE = range(len(DRIVE_MODES))


class Hold(NamedTuple):
    """The bridge's state from `after_s` after the command on: a duty -1…1 in a mode (index into `DRIVE_MODES`)."""

    after_s: float
    duty: float
    mode: int


Bridge = Callable[[int, DriveMode, float], tuple[Hold, ...]]
"""From the power commanded (%), the mode, and the duty in force before."""


def firmware_bridge(power_pct: int, mode: DriveMode, before: float) -> tuple[Hold, ...]:
    """As the brick's own firmware does: duty in whole steps, and a motor that is let go fades."""
    if mode == "coast":
        steps = int(abs(before) * 100.0 / _FADE_PCT_PER_S / _FADE_S)
        sign = 1.0 if before > 0.0 else -1.0
        lost = _FADE_S * _FADE_PCT_PER_S / 100.0
        fading = tuple(
            Hold(n * _FADE_S, sign * (abs(before) - (n + 0.5) * lost), FLOAT) for n in range(steps)
        )
        return (*fading, Hold(steps * _FADE_S, 0.0, COAST))
    steps = min(abs(power_pct) * PULSE_STEPS // 100, PULSE_STEPS)
    duty = (steps if power_pct >= 0 else -steps) / PULSE_STEPS
    if not steps:
        return (Hold(0.0, 0.0, COAST if mode == "float" else BRAKE),)
    return (Hold(0.0, duty, DRIVE_MODES.index(mode)),)


def plain_bridge(power_pct: int, mode: DriveMode, before: float) -> tuple[Hold, ...]:
    """As a recording tells it: the duty at once."""
    del before
    return (Hold(0.0, power_pct / 100.0, DRIVE_MODES.index(mode)),)
