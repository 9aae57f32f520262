"""The smallest step that an encoder counts, where it is not a whole degree."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import PORTS
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.steps import smallest_step

TACHO_STEP_KEY: Final = "tacho_step_deg"
_LARGEST_DEG = 360.0
_WHOLE_DEG = 1.0


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


def tacho_step_deg(recording: Recording, port: str) -> float:
    """The step of a port's encoder, deg: what the sidecar tells, else 1 for whole counts, else what the counts show."""
    if port in recording.tacho_step_deg:
        return recording.tacho_step_deg[port]
    return smallest_step(_counts(recording, port)) if has_untold_step(recording, port) else _WHOLE_DEG


def has_untold_step(recording: Recording, port: str) -> bool:
    """Whether a port's counts hold fractions of a degree, and no sidecar tells of what step."""
    counts = _counts(recording, port)
    return port not in recording.tacho_step_deg and bool(np.any(counts != np.rint(counts)))


def untold_step(recording: Recording, port: str) -> str | None:
    """One line on counts whose step had to be found; None where none had to be."""
    if not has_untold_step(recording, port):
        return None
    step = smallest_step(_counts(recording, port))
    taken = f"steps of {step:.4g} deg are taken" if step else "no step shows in them, and none is taken"
    where = f"{recording.name}, column {port}_tacho_deg"
    key = f"`{TACHO_STEP_KEY}: {step or 0.088:.4g}` into {Path(recording.name).with_suffix('.yaml').name}"
    return f"{where}: counts in fractions of a degree: {taken} (write {key}, with the encoder's own step)"


def _counts(recording: Recording, port: str) -> FloatArray:
    counts = recording.columns.get(f"{port}_tacho_deg", np.zeros(0))
    return counts[np.isfinite(counts)]
