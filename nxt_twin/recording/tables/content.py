"""The format of a table's file, by its content and never by its name."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.labels import is_labelled
from nxt_twin.recording.tables.lines import MARKS, WHITESPACE, TextLayout

TableKind = Literal["csv", "json", "labels", "parquet", "feather", "mat", "mcap", "db3", "lerobot"]

EMPTY_WORDS = ("", "nan", "NaN", "NAN", "NA", "N/A", "n/a", "null", "NULL", "None", "none", "-nan")
"""What other programs write into a cell that is empty."""

_SIGNATURES: tuple[tuple[bytes, TableKind], ...] = (
    (b"PAR1", "parquet"),
    (b"ARROW1", "feather"),
    (b"MATLAB 5.0 MAT", "mat"),
    (b"\x89HDF", "mat"),
    (b"\x89MCAP0", "mcap"),
    (b"SQLite format 3\0", "db3"),
)
_REFUSED = (
    (b"PK\x03\x04", "is a zip archive or a spreadsheet", "export the sheet as CSV UTF-8"),
    (b"\xd0\xcf\x11\xe0", "is an old spreadsheet", "export the sheet as CSV UTF-8"),
    (b"\x1f\x8b", "is compressed by gzip", "unpack it"),
    (b"\x28\xb5\x2f\xfd", "is compressed by Zstandard", "unpack it: unzstd FILE"),
    (b"#ROSBAG", "is a bag of ROS 1", "turn it into MCAP: mcap convert"),
)
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_DELIMITERS = (";", "\t", ",", "|", WHITESPACE)
_SAMPLE_LINES = 200
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_COMMA_NUMBER = re.compile(r"[+-]?(\d*|\d{1,3}(\.\d{3})+),\d+([eE][+-]?\d+)?")
_FEW_LINES, _MANY_CELLS = 16, 32  # a table that lies on its side has few long lines


def kind_of(path: Path) -> TableKind:
    """The format of the table in `path`.

    Raises:
        RecordingError: it cannot be opened, or is of a kind that is not read.
    """
    if path.is_dir():
        return "lerobot"
    head = read_table_head(path, RecordingError)
    for signature, what, mend in _REFUSED:
        if head.startswith(signature):
            raise RecordingError(what, where=str(path), mend=mend)
    for signature, kind in _SIGNATURES:
        if head.startswith(signature):
            return kind
    if b"\0" in head and not head.startswith(_UTF_16):
        if path.suffix.lower() == ".mat":  # version 4 has no signature
            return "mat"
        mend = "a table is CSV, JSON, Parquet, Feather, MAT or a bag of ROS 2"
        raise RecordingError("is a binary file of no known kind", where=str(path), mend=mend)
    if head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"["):
        return "json"
    return "labels" if is_labelled(_decoded(head)[0].splitlines()[:_SAMPLE_LINES]) else "csv"


def check_stated_kind(path: Path, stated: TableKind) -> None:
    """Refuse a format that the mapping states and the file's first bytes contradict.

    Raises:
        RecordingError: they do, or the file cannot be opened.
    """
    if path.is_dir() and stated == "lerobot":
        return
    head = read_table_head(path, RecordingError)
    found = next((kind for signature, kind in _SIGNATURES if head.startswith(signature)), None)
    if found is None and stated in ("parquet", "feather", "mcap", "db3"):
        found = kind_of(path)
    if found not in (None, stated):
        mend = f"write `table: {{format: {found}}}`, or leave `table` out"
        raise RecordingError(f"is {found}, not {stated}", where=f"{path}, mapping key table", mend=mend)


def text_layout(path: Path, given: Mapping[str, object]) -> TextLayout:
    """How the text table in `path` is cut into cells, from its first 64 KiB.

    Args:
        path: the file.
        given: what is known of it, by the names of `TextLayout`.

    Raises:
        RecordingError: it cannot be opened.
    """
    text, encoding = _decoded(read_table_head(path, RecordingError))
    lines = text.splitlines()[:_SAMPLE_LINES]
    rated = [(_rating(lines, delimiter), delimiter) for delimiter in _DELIMITERS]
    delimiter = str(given.get("delimiter") or max(rated, key=lambda each: each[0])[1])  # of equals the first
    cells = [_cut(line, delimiter) for line in lines]
    width = _common_width(cells)
    skip = next(
        (n for n, row in enumerate(cells) if len(row) == width or _is_remark(row, width, delimiter)), 0
    )
    body = [row[len(row) == width + 1 and _is_remark(row, width, delimiter) :] for row in cells[skip:] if row]
    lies = len(body) <= _FEW_LINES and width >= _MANY_CELLS and _is_values(body[0][1:])
    transposed = bool(given.get("transposed", lies))
    header = bool(body) and not (_is_value(body[0][0]) if transposed else _is_values(body[0]))
    below = body[1:3]
    units_row = header and len(below) == 2 and _is_words(below[0]) and _is_values(below[1])
    decimal = "," if _has_comma_numbers(body) else "."
    found = TextLayout(
        delimiter=delimiter,
        header=header,
        transposed=transposed,
        decimal=decimal,
        prose=True,
        thousands="." if decimal == "," and _has_thousands(text, delimiter) else "",
        skip=skip,
        units_row=units_row and not transposed,
        encoding=encoding,
        empty=EMPTY_WORDS,
    )
    return replace(found, **given)  # type: ignore[arg-type]  # the names and types of a mapping's keys


def _decoded(head: bytes) -> tuple[str, str]:
    """The text of whole lines in the head, and its encoding."""
    if head.startswith(_UTF_16):
        return head[: len(head) // 2 * 2].decode("utf-16", errors="ignore"), "utf-16"
    whole = head[: head.rfind(b"\n") + 1] or head
    try:
        return whole.decode("utf-8-sig"), "utf-8-sig"
    except UnicodeDecodeError:
        return whole.decode("cp1252", errors="replace"), "cp1252"


def _rating(lines: Sequence[str], delimiter: str) -> tuple[float, int]:
    """How well a delimiter cuts the lines into as many numbers each; then how many."""
    cells = [row for row in (_cut(line, delimiter) for line in lines) if row]
    width = _common_width(cells)
    if width < 2:
        return 0.0, width
    fitting = [row for row in cells if len(row) == width]
    numbers = sum(_is_value(cell) for row in fitting for cell in row)
    share = numbers / (width * len(fitting))
    return round(share * len(fitting) / len(cells), 3), 0


def _is_remark(row: Sequence[str], width: int, delimiter: str) -> bool:
    """Whether a line is a header behind a mark that is a word of its own, as numerical programs write it."""
    return delimiter == WHITESPACE and len(row) == width + 1 and row[0] in MARKS


def _common_width(cells: Sequence[Sequence[str]]) -> int:
    widths = Counter(len(row) for row in cells if row)
    return max(widths, key=lambda width: (widths[width], width), default=0)


def _cut(line: str, delimiter: str) -> list[str]:
    if not line.strip():
        return []
    if delimiter == WHITESPACE:
        return line.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]
    except csv.Error:
        return []


def _is_value(cell: str) -> bool:
    return cell in EMPTY_WORDS or bool(_NUMBER.fullmatch(cell) or _COMMA_NUMBER.fullmatch(cell))


def _is_words(row: Sequence[str]) -> bool:
    """Whether a line holds words and no number, as a row of units does; a column without a unit leaves it empty."""
    return any(row) and not any(_is_value(cell) for cell in row if cell)


def _is_values(row: Sequence[str]) -> bool:
    """Whether a line is a row of a table rather than its header: at least half of its cells are values."""
    return sum(map(_is_value, row)) * 2 >= len(row) and any(cell not in EMPTY_WORDS for cell in row)


def _has_thousands(text: str, delimiter: str) -> bool:
    cells = (cell for line in text.splitlines() if "." in line for cell in _cut(line, delimiter))
    return any("." in cell and bool(_COMMA_NUMBER.fullmatch(cell)) for cell in cells)


def _has_comma_numbers(rows: Sequence[Sequence[str]]) -> bool:
    cells = [cell for row in rows for cell in row]
    commas = sum(bool(_COMMA_NUMBER.fullmatch(cell)) for cell in cells)
    return commas > sum("." in cell and bool(_NUMBER.fullmatch(cell)) for cell in cells)
