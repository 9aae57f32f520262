"""CSV and other text tables: read at Arrow's speed where they are plain, line by line where they are not."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.floats import floats
from nxt_twin.recording.tables.lines import (
    UTF_8,
    WHITESPACE,
    TextLayout,
    column_names,
    first_line,
    iterate_lines,
    place_in_lines,
    read_lines,
    read_transposed,
)
from nxt_twin.recording.tables.table import Choose, Table

_SIGNATURES = (
    (b"PAR1", "is a Parquet file, not text", "name it .parquet"),
    (b"PK\x03\x04", "is a zip archive or a spreadsheet, not text", "export it as CSV UTF-8"),
    (b"MATLAB 5.0 MAT", "is a MAT file, not text", "read it through a mapping with format: mat"),
    (b"\xff\xfe", "is UTF-16, not UTF-8", UTF_8),
    (b"\xfe\xff", "is UTF-16, not UTF-8", UTF_8),
)


def read_text(path: Path, layout: TextLayout, choose: Choose) -> Table:
    """Read the chosen columns of a text table.

    Raises:
        RecordingError: if the file is no UTF-8 text table, or holds a ragged line or a cell that is no finite
            number where one is due. `choose` may raise its own.
    """
    head = read_table_head(path, RecordingError)
    is_wide = layout.encoding == "utf-16"
    for signature, what, mend in _SIGNATURES:
        if head.startswith(signature) and not is_wide:
            raise RecordingError(what, where=str(path), mend=mend)
    if b"\0" in head and not is_wide:
        raise RecordingError("is a binary file, not text", where=str(path), mend="export it as CSV UTF-8")
    if layout.transposed:
        return read_transposed(path, layout, choose)
    is_plain = layout.delimiter != WHITESPACE and not layout.thousands
    table = _read_plain(path, layout, choose) if is_plain else None
    return table or read_lines(path, layout, choose)


def _read_plain(path: Path, layout: TextLayout, choose: Choose) -> Table | None:
    """Read by Arrow; None if anything in the file is not plain, so that the slow reader can say what."""
    lines = iterate_lines(path, layout)
    first = first_line(lines, path)
    lines.close()
    names = column_names(first, layout)
    wanted = choose(names)
    # Columns go to Arrow by position: a header may name two of them alike.
    keys = {name: str(names.index(name)) for name in wanted}
    types = {keys[name]: pa.float64() if kind == "number" else pa.string() for name, kind in wanted.items()}
    try:
        columns = pyarrow.csv.read_csv(
            path,
            read_options=pyarrow.csv.ReadOptions(
                column_names=[str(position) for position in range(len(names))],
                skip_rows=_lines_before_rows(path, layout),
                encoding=layout.encoding.replace("utf-8-sig", "utf-8"),
            ),
            parse_options=pyarrow.csv.ParseOptions(delimiter=layout.delimiter),
            convert_options=pyarrow.csv.ConvertOptions(
                column_types=types,
                include_columns=list(types),
                null_values=list(layout.empty),
                strings_can_be_null=True,
                decimal_point=layout.decimal,
            ),
        )
    except (pa.ArrowInvalid, UnicodeError):
        return None
    numbers = {}
    words = {}
    for name, kind in wanted.items():
        column = columns[keys[name]]
        if kind != "number":
            words[name] = tuple(word.strip() if word else "" for word in column.to_pylist())
            continue
        numbers[name] = floats(column)
        if np.count_nonzero(~np.isfinite(numbers[name])) > column.null_count:
            return None
    return Table(numbers, words, lambda index, name: place_in_lines(path, layout, index, name))


def _lines_before_rows(path: Path, layout: TextLayout) -> int:
    """How many lines of the file come before the first row."""
    if not layout.head_lines:
        return layout.skip
    head = islice(iterate_lines(path, layout), layout.head_lines)
    return max(number for number, _ in head)
