"""The whole steps in which a brick's bridge takes its duty."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError

PULSE_STEPS: Final = 125
"""The pulse width counter's top, in the brick's co-processor: what lies between two steps is cut off."""
PULSES_KEY: Final = "pulse_steps"
_SLACK = 1e-9  # of a step: 56 % are 70 of them


def known_pulse_steps(sidecar: Mapping[str, Any], where: str) -> int:
    """The number of duty steps that a recording's sidecar states (docs/formats.md#sidecars).

    Without one it is 0: a duty acts as commanded.

    Raises:
        RecordingError: it is no such number.
    """
    told = sidecar.get(PULSES_KEY, 0)
    if isinstance(told, bool) or not isinstance(told, int) or told < 0:
        mend = f"{PULSE_STEPS} for an NXT, or take it out"
        raise RecordingError("is no number of steps", where=f"{where}, key {PULSES_KEY}", mend=mend)
    return told


def pulsed(duty: FloatArray, steps: int) -> FloatArray:
    """The duties (-1…1) that a bridge with a number of steps really gives; with 0 steps, any."""
    if not steps:
        return duty
    return np.copysign(np.floor(np.abs(duty) * steps + _SLACK) / steps, duty)
