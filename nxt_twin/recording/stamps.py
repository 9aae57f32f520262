"""The time of each row of a table from elsewhere, and the order of its rows."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from datetime import UTC, datetime
from types import MappingProxyType

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.checks import check_gaps, check_stamps
from nxt_twin.recording.clock import clock_s, past_midnight
from nxt_twin.recording.mapping import TimeSource, TimeUnit
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.table import Table

IN_WORDS: tuple[TimeUnit, ...] = ("iso", "clock")
_SECONDS: MappingType[TimeUnit, float] = MappingProxyType({"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9})
_MENDS = (
    "; in a mapping, write `split: {column: …}` for several runs (`falls: true` where their time begins anew), "
    "`time: {wraps_at: 65536}` for a counter that starts anew, or `time: {sort: true}`"
)


def time_s(table: Table, source: TimeSource, rows: int) -> FloatArray:
    """The moments of a table's rows, s, shape (rows,).

    Raises:
        RecordingError: a stamp is missing or none, or they run backwards or leap by more than an hour.
    """
    if source.column is None:
        return np.arange(rows, dtype=np.float64) * (source.period_s or 0.0)
    stamps = _stamps(table, source)
    if source.wraps_at is not None:
        stamps = np.unwrap(stamps, period=source.wraps_at)
    read = Table({source.column: stamps}, {}, table.place)
    check_stamps(read, source.column, or_else=_MENDS)
    moments: FloatArray = stamps * _SECONDS.get(source.unit, 1.0)
    check_gaps(read, source.column, moments)
    return moments


def order(table: Table, source: TimeSource) -> IntArray | None:
    """The rows in the order of their stamps; None where they stay as they are."""
    if source.column is None or not source.sort:
        return None
    return np.argsort(_stamps(table, source), kind="stable")


def _stamps(table: Table, source: TimeSource) -> FloatArray:
    column = source.column or ""
    if source.unit not in IN_WORDS:
        return table.numbers[column]
    texts = table.words[column]
    stamps = np.array([_seconds(table, row, source) if text else np.nan for row, text in enumerate(texts)])
    return past_midnight(stamps) if source.unit == "clock" and not source.sort else stamps


def _seconds(table: Table, row: int, source: TimeSource) -> float:
    """The seconds that a date or a time of day stands for."""
    column = source.column or ""
    text = table.words[column][row]
    found = clock_s(text) if source.unit == "clock" else _since_epoch_s(text)
    if found is None:
        what = f"{quoted(text)} is no {'time of day' if source.unit == 'clock' else 'date'}"
        mend = "write another `time: {unit: …}`"
        raise RecordingError(what, where=table.place(row, column), mend=mend)
    return found


def _since_epoch_s(text: str) -> float | None:
    try:
        stamp = datetime.fromisoformat(text)
    except ValueError:
        return None
    return (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)).timestamp()
