"""The other joints of an arm, in the table of one of them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from nxt_twin.recording.guess.profile import TableColumn
from nxt_twin.recording.guess.scales import output_scale
from nxt_twin.recording.tables.nested import split_name

_STATES = ("observation.state",)
_JOINT_STATE = re.compile(r"(?P<topic>.+)\.(?P<joint>[^.]+)\.position")
_STILL_DEG = 1.0


def joints_beside(columns: Sequence[TableColumn], output: TableColumn | None) -> dict[str, dict[str, Any]]:
    """The angles of other joints that move, as `gravity_of` of a mapping takes them; empty where it is no arm's table.

    Joints are taken in the order of the table, from the arm's foot on.
    """
    if output is None or output_scale(output)[0] != "angle":
        return {}
    _, unit, size, _ = output_scale(output)
    if size != 1.0 or unit not in ("deg", "rad"):
        return {}
    arm = [column for column in columns if _is_beside(column, output)]
    place = arm.index(output) if output in arm else 0
    still = _STILL_DEG if unit == "deg" else _STILL_DEG / 57.3
    return {
        _name(column): {**column.keys, "kind": f"position_{unit}", "sign": 1.0 if number < place else 0.0}
        for number, column in enumerate(arm)
        if column is not output and column.span > still
    }


def _is_beside(column: TableColumn, output: TableColumn) -> bool:
    """Whether two columns hold the angles of joints of one arm."""
    stem, index = split_name(output.name)
    if index is not None and stem in _STATES:
        return split_name(column.name)[0] == stem
    own, other = _JOINT_STATE.fullmatch(output.name), _JOINT_STATE.fullmatch(column.name)
    return own is not None and other is not None and own["topic"] == other["topic"]


def _name(column: TableColumn) -> str:
    found = _JOINT_STATE.fullmatch(column.name)
    return column.joint or (found["joint"] if found else f"joint {column.index}")
