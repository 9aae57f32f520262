"""Parquet tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.table import CellKind, Choose, Table, check_unfolded


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
            check_unfolded(_cells(file.metadata, wanted), path)
        words = [name for name, kind in wanted.items() if kind == "word"]
        # Each word once: a file may say one that is as long as itself in every row.
        with pyarrow.parquet.ParquetFile(path, read_dictionary=words) as file:
            columns = file.read(columns=list(wanted))
    except (pa.ArrowException, OSError, ValueError) as failure:
        mend = "check that the file is whole; a text table is named .csv"
        raise RecordingError(f"is no readable Parquet file: {failure}", where=str(path), mend=mend) from None
    return Table(
        numbers={n: _numbers(columns[n], path, n) for n, kind in wanted.items() if kind == "number"},
        words={n: _words(columns[n], path, n) for n, kind in wanted.items() if kind == "word"},
        place=lambda index, name: f"{path}, row {index + 1}, column {name}",
    )


def _cells(metadata: pyarrow.parquet.FileMetaData, wanted: Mapping[str, CellKind]) -> int:
    """To how many cells the chosen columns unfold; of a column's bytes eight are one."""
    groups = [metadata.row_group(index) for index in range(metadata.num_row_groups)]
    chunks = [group.column(index) for group in groups for index in range(group.num_columns)]
    sizes = [int(chunk.total_uncompressed_size) for chunk in chunks if _is_of(chunk.path_in_schema, wanted)]
    cells: int = metadata.num_rows * len(wanted)
    return max(cells, sum(sizes) // 8)


def _is_of(place: str, wanted: Mapping[str, CellKind]) -> bool:
    """Whether a stored column is one of the wanted, or a part of one."""
    return any(place == name or place.startswith(f"{name}.") for name in wanted)


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
    texts: list[str] = []
    for chunk in (column if pa.types.is_dictionary(column.type) else column.dictionary_encode()).chunks:
        known = ["", *(word or "" for word in chunk.dictionary.to_pylist())]
        texts += [
            known[index] for index in (chunk.indices.cast(pa.int64()).fill_null(-1).to_numpy() + 1).tolist()
        ]
    return tuple(texts)
