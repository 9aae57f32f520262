"""A recording's columns as an Arrow table, and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.checks import (
    check_finite,
    check_row_count,
    check_stamps,
    checked_columns,
    held_commands,
)
from nxt_twin.recording.columns import CATALOGUE, MAPPED_COLUMNS, TIME, check_names
from nxt_twin.recording.tables.floats import arrow_numbers, arrow_words, floats
from nxt_twin.recording.tables.table import Table

_LARGEST_EXACT_INTEGER = 2.0**53


def table_of(columns: Mapping[str, FloatArray]) -> pa.Table:
    """The columns as an Arrow table: NaN as null, whole numbers as integers, modes as words."""
    return pa.table({name: _cells(name, values) for name, values in columns.items()})


def columns_of(table: object, name: str, *, mapped: bool = False) -> dict[str, FloatArray]:
    """The columns of whatever speaks Arrow's C interface, checked as those of a file are.

    Args:
        table: the data frame or table.
        name: what to call it in complaints.
        mapped: it holds `time_s`, `input` and `output` of a bench rather than a brick's columns.

    Raises:
        RecordingError: it does not speak Arrow, or its columns cannot be a recording's.
    """
    if not hasattr(table, "__arrow_c_stream__"):
        mend = "give a pandas, polars or pyarrow table"
        raise RecordingError(f"a {type(table).__name__} does not speak Arrow", where=name, mend=mend)
    held = pa.table(table)
    if mapped:
        return _mapped_columns(held, name)
    check_names(held.column_names, Path(name))
    words = [key for key in held.column_names if CATALOGUE[key].words]
    numbers = {key: _numbers(held, key, name) for key in held.column_names if key not in words}
    return checked_columns(
        Table(numbers, {key: _words(held, key) for key in words}, _place(name)), Path(name)
    )


def _mapped_columns(held: pa.Table, name: str) -> dict[str, FloatArray]:
    for missing in {TIME, "input"} - set(held.column_names):
        raise RecordingError(f"has no column {missing}", where=name, mend="a bench's table needs it")
    numbers = {key: _numbers(held, key, name) for key in (TIME, *MAPPED_COLUMNS) if key in held.column_names}
    table = Table(numbers, {}, _place(name))
    check_row_count(numbers[TIME].size, Path(name))
    check_stamps(table, TIME)
    for key, values in numbers.items():
        check_finite(table, key, values)
    return {**numbers, "input": held_commands(numbers["input"])}


def _numbers(held: pa.Table, key: str, name: str) -> FloatArray:
    try:
        return floats(held[key].cast(pa.float64()))
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError):
        mend = "give numbers"
        raise RecordingError(
            "holds something else than numbers", where=f"{name}, column {key}", mend=mend
        ) from None


def _words(held: pa.Table, key: str) -> tuple[str, ...]:
    return tuple(word or "" for word in held[key].cast(pa.string()).to_pylist())


def _place(name: str) -> Callable[[int, str], str]:
    return lambda index, key: f"{name}, row {index + 1}, column {key}"


def _cells(name: str, values: FloatArray) -> pa.Array:
    empty = np.isnan(values)
    filled = np.where(empty, 0.0, values)
    column = CATALOGUE.get(name)
    if column is not None and column.words:
        return arrow_words(column.words, filled.astype(np.int64), empty)
    if np.all(filled == np.rint(filled)) and np.all(np.abs(filled) <= _LARGEST_EXACT_INTEGER):
        return arrow_numbers(filled.astype(np.int64), empty)
    return arrow_numbers(values, empty)
