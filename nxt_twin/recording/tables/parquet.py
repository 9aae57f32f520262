"""Parquet and Feather tables; elements of lists and fields of structs are columns too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.floats import floats
from nxt_twin.recording.tables.loose import as_word
from nxt_twin.recording.tables.nested import arrow_column, arrow_names, arrow_stem
from nxt_twin.recording.tables.table import CellKind, Choose, Table, check_unfolded

if TYPE_CHECKING:
    from pyarrow import parquet


def read_parquet(path: Path, choose: Choose) -> Table:
    """Read the chosen columns of a Parquet file; nulls and NaN alike are empty cells.

    Raises:
        RecordingError: if the file is no Parquet file, unfolds to too much, or holds text where a number is
            due. `choose` may raise its own.
    """
    from pyarrow import parquet  # slow, and a text table needs none of it

    read_table_head(path, RecordingError)
    try:
        with parquet.ParquetFile(path) as file:
            wanted = choose(arrow_names(_first_rows(file)))
            stems = list(dict.fromkeys(arrow_stem(name, file.schema_arrow.names) for name in wanted))
            check_unfolded(_cells(file.metadata, stems), path)
        words = [name for name, kind in wanted.items() if kind == "word"]
        # Each word once: a file may say one that is as long as itself in every row.
        with parquet.ParquetFile(path, read_dictionary=words) as file:
            columns = file.read(columns=stems)
    except (pa.ArrowException, OSError, ValueError) as failure:
        mend = "check that the file is whole; a text table is named .csv"
        raise RecordingError(f"is no readable Parquet file: {failure}", where=str(path), mend=mend) from None
    return arrow_table(columns, wanted, path)


def read_feather(path: Path, choose: Choose) -> Table:
    """Read the chosen columns of a Feather file (Arrow IPC); nulls and NaN alike are empty cells.

    Raises:
        RecordingError: if the file is no Feather file, unfolds to too much, or holds text where a number is
            due. `choose` may raise its own.
    """
    read_table_head(path, RecordingError)
    try:
        with pa.OSFile(str(path)) as source, pa.ipc.open_file(source) as file:
            first = (
                file.get_batch(0) if file.num_record_batches else file.schema.empty_table().to_batches()[0]
            )
            wanted = choose(arrow_names(pa.Table.from_batches([first.slice(0, 1)])))
            batches = []
            for number in range(file.num_record_batches):
                batches.append(file.get_batch(number))
                check_unfolded(sum(batch.nbytes for batch in batches) // 8, path)
            columns = pa.Table.from_batches(batches, file.schema)
            columns.validate(full=True)  # a damaged file may promise more than it holds
    except (pa.ArrowException, OSError, ValueError, IndexError) as failure:
        mend = "check that the file is whole"
        raise RecordingError(f"is no readable Feather file: {failure}", where=str(path), mend=mend) from None
    return arrow_table(columns, wanted, path)


def arrow_table(columns: pa.Table, wanted: Mapping[str, CellKind], path: Path) -> Table:
    """The wanted columns as a table.

    Raises:
        RecordingError: one holds text where a number is due, or text that is damaged.
    """
    numbers: dict[str, FloatArray] = {}
    words: dict[str, tuple[str, ...]] = {}
    for name, kind in wanted.items():
        column = arrow_column(columns, name)
        if kind == "number":
            numbers[name] = _numbers(column, path, name)
            continue
        try:
            words[name] = _words(column, path, name) if kind == "word" else _labels(column)
        except UnicodeDecodeError:
            where = f"{path}, column {name}"
            raise RecordingError(
                "holds text that is not UTF-8", where=where, mend="check that the file is whole"
            ) from None
    return Table(
        numbers=numbers,
        words=words,
        place=lambda index, name: f"{path}, row {index + 1}, column {name}",
    )


def _first_rows(file: parquet.ParquetFile) -> pa.Table:
    """One row, which tells how long the lists are."""
    for batch in file.iter_batches(batch_size=1):
        return pa.Table.from_batches([batch])
    return file.schema_arrow.empty_table()


def _cells(metadata: parquet.FileMetaData, wanted: Sequence[str]) -> int:
    """To how many cells the chosen columns unfold; of a column's bytes eight are one."""
    groups = [metadata.row_group(index) for index in range(metadata.num_row_groups)]
    chunks = [group.column(index) for group in groups for index in range(group.num_columns)]
    sizes = [int(chunk.total_uncompressed_size) for chunk in chunks if _is_of(chunk.path_in_schema, wanted)]
    cells: int = metadata.num_rows * len(wanted)
    return max(cells, sum(sizes) // 8)


def _is_of(place: str, wanted: Sequence[str]) -> bool:
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
    return floats(column)


def _words(column: pa.ChunkedArray, path: Path, name: str) -> tuple[str, ...]:
    kind = column.type.value_type if pa.types.is_dictionary(column.type) else column.type
    if not (pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_null(kind)):
        where = f"{path}, column {name}"
        raise RecordingError(f"holds {column.type}, not words", where=where, mend="store it as text")
    texts: list[str] = []
    for chunk in (column if pa.types.is_dictionary(column.type) else column.dictionary_encode()).chunks:
        known = ["", *(word or "" for word in chunk.dictionary.to_pylist())]
        numbers = floats(pa.chunked_array([chunk.indices]))
        texts += [known[int(number) + 1] for number in np.nan_to_num(numbers, nan=-1.0)]
    return tuple(texts)


def _labels(column: pa.ChunkedArray) -> tuple[str, ...]:
    """Words, or numbers as words."""
    return tuple(map(as_word, column.to_pylist()))
