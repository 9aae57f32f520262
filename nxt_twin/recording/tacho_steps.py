"""The smallest step that an encoder counts, where it is not a whole degree."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import PORTS

TACHO_STEP_KEY: Final = "tacho_step_deg"
_LARGEST_DEG = 360.0


def known_tacho_steps(sidecar: Mapping[str, Any], where: str) -> dict[str, float]:
    """The encoders' steps by port that a recording's sidecar states, deg (docs/formats.md#sidecars).

    Raises:
        RecordingError: they are no steps.
    """
    told = sidecar.get(TACHO_STEP_KEY)
    if told is None:
        return {}
    steps = told if isinstance(told, Mapping) else dict.fromkeys(PORTS, told)
    if not all(str(port) in PORTS and _is_step(step) for port, step in steps.items()):
        mend = "write one number of degrees, or one for each port: {a: 0.088}"
        raise RecordingError("is no encoder step", where=f"{where}, key {TACHO_STEP_KEY}", mend=mend)
    return {str(port): float(step) for port, step in steps.items()}


def _is_step(told: object) -> bool:
    return isinstance(told, int | float) and not isinstance(told, bool) and 0.0 < told <= _LARGEST_DEG
