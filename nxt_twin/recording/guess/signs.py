"""Which value of a direction's column is forward: the one at which the reading grows."""

from __future__ import annotations

import numpy as np

from nxt_twin.recording.checks import held_commands
from nxt_twin.recording.guess.profile import TableColumn


def sign_values(sign: TableColumn, command: TableColumn, reading: TableColumn) -> dict[str, int]:
    """The sign of a command by the value of the column that tells its direction."""
    told, size, there = (
        held_commands(each.values, float(each.known[0])) for each in (sign, command, reading)
    )
    step = np.diff(there, append=there[-1]) * size
    values = np.unique(sign.known)
    paces = {value: float(np.sum(step[told == value])) for value in values.tolist()}
    forward = max(paces, key=lambda value: paces[value])
    return {
        sign.labels[int(value)] if sign.labels else f"{value:g}": 1
        if value == forward
        else (0 if value == 0.0 and values.size > 2 else -1)
        for value in paces
    }
