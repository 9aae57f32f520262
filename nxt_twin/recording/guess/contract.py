"""Whether a table is a recording as it stands."""

from __future__ import annotations

from pathlib import Path

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.columns import PORTS, power_column
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.tacho_steps import has_untold_step


def is_recording(path: Path) -> bool:
    """Whether the table has a recording's own columns, and the encoders of its driven motors count in known steps.

    Fractions of a degree, where no sidecar tells of such, are better read through a mapping that states the step.
    """
    try:
        recording = read_recording(path)
    except NxtTwinError:
        return False
    driven = [port for port in PORTS if power_column(port) in recording.columns]
    return not any(has_untold_step(recording, port) for port in driven)
