"""JSON tables: a list of rows, lists by column, or one row a line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_head
from nxt_twin.recording.tables.loose import loose_table
from nxt_twin.recording.tables.table import LARGEST_CELLS, Choose, Table

LARGEST_JSON_BYTES = 128 * 2**20
"""JSON takes about ten times its size while it is read."""

_DEEPEST = 8


def read_json(path: Path, choose: Choose) -> Table:
    """Read the chosen columns of a JSON file; `a.b` is key b of object a, `a[0]` the first of list a.

    Raises:
        RecordingError: if the file is no JSON, or holds no table. `choose` may raise its own.
    """
    advice = "split it into shorter recordings, or save it as Parquet"
    read_head(path, RecordingError, largest_bytes=LARGEST_JSON_BYTES, advice=advice)
    try:
        columns = _columns(_rows(path.read_text(encoding="utf-8-sig"), path), path)
    except UnicodeDecodeError:
        raise RecordingError("is not UTF-8 text", where=str(path), mend="save it as UTF-8") from None
    except RecursionError:
        raise RecordingError("is nested too deeply", where=str(path), mend="save it as CSV") from None
    return loose_table(columns, path, choose)


def _rows(text: str, path: Path) -> Iterator[Mapping[str, object]]:
    try:
        whole = json.loads(text)
    except ValueError:  # no JSON, or a number of thousands of digits
        yield from _lines(text, path)
        return
    yield from _rows_of(whole, path)


def _lines(text: str, path: Path) -> Iterator[Mapping[str, object]]:
    """One object a line; a last line that was cut off is left out."""
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            row = json.loads(line)
        except ValueError as failure:
            if number == len(lines) and number > 1:
                return
            where = f"{path}, row {number}"
            raise RecordingError(f"is no JSON: {failure}", where=where, mend="check that line") from None
        yield row if isinstance(row, dict) else _numbered(row)


def _rows_of(whole: object, path: Path) -> Iterator[Mapping[str, object]]:
    if isinstance(whole, list):
        yield from (row if isinstance(row, dict) else _numbered(row) for row in whole)
        return
    if isinstance(whole, dict):
        lists = {key: value for key, value in whole.items() if isinstance(value, list)}
        if len(lists) == 1 and all(isinstance(row, dict) for row in next(iter(lists.values()))):
            yield from next(iter(lists.values()))
            return
        if lists:
            if len({len(value) for value in lists.values()}) > 1:
                sizes = ", ".join(f"{key} {len(value)}" for key, value in lists.items())
                mend = "give its columns one length"
                raise RecordingError(f"its lists differ in length: {sizes}", where=str(path), mend=mend)
            yield from (dict(zip(lists, row, strict=True)) for row in zip(*lists.values(), strict=True))
            return
        tables = [value for value in whole.values() if isinstance(value, dict) and _holds_lists(value)]
        if len(tables) == 1:
            yield from _rows_of(tables[0], path)
            return
        yield whole
        return
    raise RecordingError("is JSON that holds no table", where=str(path), mend="write a list of rows")


def _holds_lists(found: dict[str, object]) -> bool:
    """Whether an object holds columns."""
    return sum(isinstance(value, list) for value in found.values()) > 1


def _numbered(row: object) -> Mapping[str, object]:
    cells = row if isinstance(row, list) else [row]
    return {f"c{number}": cell for number, cell in enumerate(cells, 1)}


def _columns(rows: Iterator[Mapping[str, object]], path: Path) -> dict[str, list[object]]:
    columns: dict[str, list[object]] = {}
    count = 0
    for row in rows:
        for name, cell in _flat(row, "", 0):
            column = columns.setdefault(name, [])
            column += [None] * (count - len(column))
            column[count:] = [cell]
        count += 1
        if count * len(columns) > LARGEST_CELLS // 8:
            mend = "split it into shorter recordings, or save it as Parquet"
            raise RecordingError("holds too many cells", where=str(path), mend=mend)
    for column in columns.values():
        column += [None] * (count - len(column))
    return columns


def _flat(cell: object, name: str, depth: int) -> Iterator[tuple[str, object]]:
    """The cells within a cell, by their full names."""
    if depth > _DEEPEST:
        return
    if isinstance(cell, dict):
        for key, value in cell.items():
            yield from _flat(value, f"{name}.{key}" if name else str(key), depth + 1)
    elif isinstance(cell, list):
        for index, value in enumerate(cell):
            yield from _flat(value, f"{name}[{index}]", depth + 1)
    else:
        yield name, cell
