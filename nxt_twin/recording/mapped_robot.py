"""Tables of robots from elsewhere, as recordings with the columns of a brick."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.checks import check_finite, check_range, check_row_count, held_commands
from nxt_twin.recording.columns import (
    BATTERY,
    POSE_HEADING,
    POSE_X,
    POSE_Y,
    TIME,
    Port,
    power_column,
    tacho_column,
)
from nxt_twin.recording.mapping import POWER_LIMIT_PCT
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.robot_mapping import (
    DEGREES,
    FULL_TURN_DEG,
    METRES,
    AngleSource,
    DutySource,
    LengthSource,
    RobotMapping,
)
from nxt_twin.recording.stamps import time_s
from nxt_twin.recording.tables.table import Table

LEFT: Final[Port] = "b"
RIGHT: Final[Port] = "c"
"""The ports of a mapped robot's wheels, as in the plants castor_bot and tribot."""


def robot_recording(table: Table, path: Path, mapping: RobotMapping, name: str) -> Recording:
    """A robot's recording: pose, counts of both wheels, and powers and battery where they are mapped.

    Raises:
        RecordingError: a mapped column is empty, or its stamps or values cannot be a recording's.
    """
    rows = next(iter(table.numbers.values())).size
    check_row_count(rows, path)
    for column, values in table.numbers.items():
        check_finite(table, column, values)
    for key in ("pose_x", "pose_y", "pose_heading", "left_angle", "right_angle"):
        _check_filled(table, path, key, getattr(mapping, key).column)
    with np.errstate(over="ignore", invalid="ignore"):  # refused below
        columns = _columns(table, mapping, rows)
    for signal, values in columns.items():
        if np.isinf(values).any():
            mend = "check the mapping's gain and unit"
            raise RecordingError("becomes larger than a number can be", where=f"{path}, {signal}", mend=mend)
    sources: dict[str, AngleSource] = {LEFT: mapping.left_angle, RIGHT: mapping.right_angle}
    steps = {port: _step_deg(table, source) for port, source in sources.items()}
    told = {port: step for port, step in steps.items() if step}
    return Recording(name=name, columns=columns, tacho_step_deg=told)


def _check_filled(table: Table, path: Path, key: str, column: str) -> None:
    if np.isnan(table.numbers[column]).all():
        mend = f"write the column that was measured as `{key}: {{column: …}}`"
        raise RecordingError("is empty", where=f"{path}, column {column}", mend=mend)


def _columns(table: Table, mapping: RobotMapping, rows: int) -> dict[str, FloatArray]:
    columns = {
        TIME: time_s(table, mapping.time, rows),
        tacho_column(LEFT): _angle_deg(table, mapping.left_angle),
        tacho_column(RIGHT): _angle_deg(table, mapping.right_angle),
        POSE_X: _length_m(table, mapping.pose_x),
        POSE_Y: _length_m(table, mapping.pose_y),
        POSE_HEADING: _unwrapped(_angle_deg(table, mapping.pose_heading), FULL_TURN_DEG),
    }
    for port, source in ((LEFT, mapping.left_power), (RIGHT, mapping.right_power)):
        if source is not None:
            columns[power_column(port)] = _power_pct(table, source)
    if mapping.supply is not None:
        supply = mapping.supply
        columns[BATTERY] = table.numbers[supply.column] * supply.gain + supply.offset
    return columns


def _length_m(table: Table, source: LengthSource) -> FloatArray:
    return (table.numbers[source.column] * source.gain + source.offset) * METRES[source.unit]


def _angle_deg(table: Table, source: AngleSource) -> FloatArray:
    values = table.numbers[source.column]
    if source.wraps_at is not None:
        values = _unwrapped(values, source.wraps_at)
    return (values * source.gain + source.offset) * DEGREES[source.unit]


def _power_pct(table: Table, source: DutySource) -> FloatArray:
    values = held_commands(table.numbers[source.column] * source.gain + source.offset)
    mend = "write a `gain:` for it, such as 0.392 for a duty of 8 bits"
    check_range(table, source.column, values, -POWER_LIMIT_PCT, POWER_LIMIT_PCT, mend=mend)
    return values


def _unwrapped(values: FloatArray, period: float) -> FloatArray:
    known = np.isfinite(values)
    whole = values.copy()
    whole[known] = np.unwrap(values[known], period=period)
    return whole


def _step_deg(table: Table, source: AngleSource) -> float:
    """A count's size in degrees, where the column holds counts; else 0."""
    known = table.numbers[source.column]
    known = known[np.isfinite(known)]
    is_counted = bool(np.all(known == np.rint(known)))
    return abs(source.gain) * DEGREES[source.unit] if is_counted else 0.0
