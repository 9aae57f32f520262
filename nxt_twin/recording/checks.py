"""The checks on a recording's values, and commands held from row to row."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import CATALOGUE, TIME, Column
from nxt_twin.recording.source import nearest_name, quoted
from nxt_twin.recording.tables.table import Table

_FEWEST_ROWS = 2
_CHECK_SCALE = "check the column's unit and scale"
LONGEST_GAP_S = 3600.0
"""Slow polls are minutes apart; more than an hour between two rows is a clock that was set, or another unit."""


def checked_columns(table: Table, path: Path) -> dict[str, FloatArray]:
    """Check a table's values against the catalogue, and fill its commands in.

    Returns:
        The columns, words as indices. Commands hold from row to row (0 and `drive` before the first), so
        that only readings hold NaN.

    Raises:
        RecordingError: for too few rows, stamps that are missing, run backwards or leap ahead, infinite values,
            values outside a column's range, and unknown words.
    """
    check_row_count(table.numbers[TIME].size, path)
    check_stamps(table, TIME)
    check_gaps(table, TIME, table.numbers[TIME])
    indices = {name: _indices(table, name, CATALOGUE[name]) for name in table.words}
    columns = {}
    for name, values in {**table.numbers, **indices}.items():
        column = CATALOGUE[name]
        check_finite(table, name, values)
        check_range(table, name, values, column.lowest, column.highest)
        columns[name] = held_commands(values) if column.role == "command" else values
    return columns


def check_row_count(rows: int, path: Path) -> None:
    """Refuse a table of fewer than two rows, which shows no change.

    Raises:
        RecordingError: if it has fewer.
    """
    if rows < _FEWEST_ROWS:
        held = "no rows" if rows == 0 else "only one row"
        raise RecordingError(f"holds {held}", where=str(path), mend="record at least two")


def check_stamps(table: Table, name: str, *, or_else: str = "") -> None:
    """Refuse stamps that are missing, infinite, or smaller than the one before; equal ones are data.

    Args:
        table: where `name` is a column.
        name: of the column of stamps.
        or_else: what else mends stamps that run backwards, after a semicolon.

    Raises:
        RecordingError: naming the first row in which that is so.
    """
    stamps = table.numbers[name]
    missing = ~np.isfinite(stamps)
    if missing.any():
        where = table.place(int(missing.argmax()), name)
        raise RecordingError("has no time stamp", where=where, mend="give every row its stamp or delete it")
    backwards = np.diff(stamps) < 0.0
    if backwards.any():
        row = int(backwards.argmax()) + 1
        what = f"time runs backwards, from {stamps[row - 1]:.10g} to {stamps[row]:.10g}"
        mend = f"split the recording where its clock was set anew, or sort its rows{or_else}"
        raise RecordingError(what, where=table.place(row, name), mend=mend)


def check_gaps(table: Table, name: str, time_s: FloatArray) -> None:
    """Refuse two rows that are further apart than any recording's: what is run over it would run for ever.

    Args:
        table: where `name` is a column.
        name: of the column of stamps.
        time_s: the stamps, s.

    Raises:
        RecordingError: naming the first row that is too far from the one before.
    """
    gaps = np.diff(time_s)
    if gaps.size and gaps.max() > LONGEST_GAP_S:
        row = int((gaps > LONGEST_GAP_S).argmax()) + 1
        what = f"time leaps by {gaps[row - 1]:.6g} s, more than {LONGEST_GAP_S:g} s"
        mend = "check the unit of the stamps, or split the recording there"
        raise RecordingError(what, where=table.place(row, name), mend=mend)


def check_finite(table: Table, name: str, values: FloatArray) -> None:
    """Refuse infinite values; NaN is an empty cell.

    Raises:
        RecordingError: naming the first row that holds one.
    """
    infinite = np.isinf(values)
    if infinite.any():
        where = table.place(int(infinite.argmax()), name)
        mend = "leave the cell empty where nothing was sampled"
        raise RecordingError("is not finite", where=where, mend=mend)


def check_range(
    table: Table, name: str, values: FloatArray, lowest: float, highest: float, *, mend: str = _CHECK_SCALE
) -> None:
    """Refuse values that the thing measured or commanded cannot take.

    Raises:
        RecordingError: naming the first row that holds one.
    """
    outside = (values < lowest) | (values > highest)
    if outside.any():
        row = int(outside.argmax())
        what = f"{values[row]:.10g} is outside {lowest:g} to {highest:g}"
        raise RecordingError(what, where=table.place(row, name), mend=mend)


def held_commands(commands: FloatArray, before_first: float = 0.0) -> FloatArray:
    """Fill each empty command with the one in force: the last before it, or `before_first`."""
    numbers = np.arange(1, commands.size + 1)
    latest = np.maximum.accumulate(np.where(np.isnan(commands), 0, numbers))
    return np.concatenate(([before_first], commands))[latest]


def _indices(table: Table, name: str, column: Column) -> FloatArray:
    index_of = {word: float(index) for index, word in enumerate(column.words)} | {"": np.nan}
    words = table.words[name]
    for word in sorted(set(words) - set(index_of)):
        what = f"{quoted(word)} is no known word"
        mend = f"nearest known: {nearest_name(word, column.words)}; known: {', '.join(column.words)}"
        raise RecordingError(what, where=table.place(words.index(word), name), mend=mend)
    return np.array([index_of[word] for word in words], dtype=np.float64)
