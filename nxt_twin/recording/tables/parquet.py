"""Parquet tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.table import LARGEST_CELLS, Choose, Table


def read_parquet(path: Path, choose: Choose) -> Table:
    """Read the chosen columns of a Parquet file; nulls and NaN alike are empty cells.

    Raises:
        RecordingError: if the file is no Parquet file, unfolds to too much, or holds text where a number is
            due. `choose` may raise its own.
    """
    read_table_head(path, RecordingError)
    try:
        with pyarrow.parquet.ParquetFile(path) as file:
            wanted = choose(file.schema_arrow.names)
            if file.metadata.num_rows * len(wanted) > LARGEST_CELLS:
                mend = "split it into shorter recordings"
                raise RecordingError(f"has {file.metadata.num_rows} rows", where=str(path), mend=mend)
            columns = file.read(columns=list(wanted))
    except (pa.ArrowException, OSError, ValueError) as failure:
        mend = "check that the file is whole; a text table is named .csv"
        raise RecordingError(f"is no readable Parquet file: {failure}", where=str(path), mend=mend) from None
    return Table(
        numbers={n: _numbers(columns[n], path, n) for n, kind in wanted.items() if kind == "number"},
        words={n: _words(columns[n], path, n) for n, kind in wanted.items() if kind == "word"},
        place=lambda index, name: f"{path}, row {index + 1}, column {name}",
    )


def _numbers(column: pa.ChunkedArray, path: Path, name: str) -> FloatArray:
    kind = column.type
    is_number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)
    if not (is_number or pa.types.is_boolean(kind) or pa.types.is_null(kind)):
        where = f"{path}, column {name}"
        raise RecordingError(f"holds {kind}, not numbers", where=where, mend="store it as a number")
    if pa.types.is_boolean(kind):
        column = column.cast(pa.int8())
    return np.asarray(column.cast(pa.float64(), safe=False).to_numpy(), dtype=np.float64)


def _words(column: pa.ChunkedArray, path: Path, name: str) -> tuple[str, ...]:
    kind = column.type.value_type if pa.types.is_dictionary(column.type) else column.type
    if not (pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_null(kind)):
        where = f"{path}, column {name}"
        raise RecordingError(f"holds {column.type}, not words", where=where, mend="store it as text")
    return tuple(word or "" for word in column.to_pylist())
