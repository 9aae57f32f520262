"""The last commands of a recording's motors."""

from __future__ import annotations

from nxt_twin.recording.columns import DRIVE_MODES, PORTS, Port, mode_column, power_column
from nxt_twin.recording.recording import Recording

_DRIVEN = (DRIVE_MODES.index("drive"), DRIVE_MODES.index("float"))


def driven_at_the_end(recording: Recording) -> dict[Port, float]:
    """The power, percent, of each motor that the last row drives: a brick that nobody stops goes on so."""
    columns = recording.columns
    return {
        port: float(columns[power_column(port)][-1])
        for port in PORTS
        if power_column(port) in columns
        and columns[power_column(port)][-1] != 0.0
        and (mode_column(port) not in columns or columns[mode_column(port)][-1] in _DRIVEN)
    }
