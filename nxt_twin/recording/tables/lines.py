"""Text tables, cell by cell: slow, tolerant of blanks, and exact about where something is wrong."""

from __future__ import annotations

import csv
import math
import re
from array import array
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import Literal, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.table import Choose, Table

WHITESPACE: Literal["whitespace"] = "whitespace"

MARKS = ("#", "%", "//")
"""What stands before a header that is a remark, as numerical programs write it."""
_LEAVE_EMPTY = "leave the cell empty where nothing was sampled"
_UNITED = re.compile(r"[+-]?\d+(?:[.,]\d+)?\s*[^\W\d_][^\d\s]{0,6}|[+-]?\d+(?:[.,]\d+)?\s*[%°]\w?")

NumberedLine = tuple[int, list[str]]
Cell = tuple[Path, int, str]
"""A cell's file, line and column."""


@final
@dataclass(frozen=True)
class TextLayout:
    """How a text file is cut into cells.

    Attributes:
        delimiter: one character, or `whitespace` for runs of blanks.
        header: whether the first line names the columns; without, they are c1, c2, …
        transposed: whether each line is a column, named by its first cell if there is a header.
        decimal: the mark between whole and fraction, a point or a comma.
        skip: how many lines come before the header, or before the first row.
        units_row: whether the line below the header holds units rather than values.
        encoding: of the text, by Python's name.
        empty: what stands in a cell that is empty.
        prose: whether lines of words between the rows are left out.
        ragged: what becomes of lines that have another number of cells; empty: they are refused.
        thousands: the mark between thousands, if there is one.
    """

    delimiter: str = ","
    header: bool = True
    transposed: bool = False
    decimal: str = "."
    skip: int = 0
    units_row: bool = False
    encoding: str = "utf-8-sig"
    empty: tuple[str, ...] = ("",)
    prose: bool = False
    ragged: str = ""
    thousands: str = ""

    @property
    def head_lines(self) -> int:
        """How many lines that are not blank come before the first row, from the header on."""
        return int(self.header) + int(self.units_row)


def iterate_lines(path: Path, layout: TextLayout) -> Generator[NumberedLine]:
    """Yield the number (from 1) and the stripped cells of every line of the table, header included.

    Blank lines are none, nor are those that the layout leaves out.

    Raises:
        RecordingError: if the text is not UTF-8 or its quotes never close.
    """
    width = 0
    for number, cells in _all_lines(path, layout):
        if not width:
            cells = cells[_has_mark(cells, layout) :]
            width = len(cells)
        elif len(cells) != width and _is_left_out(cells, layout, width):
            continue
        yield number, cells


def _has_mark(cells: list[str], layout: TextLayout) -> bool:
    """Whether the header is a remark, its mark a word of its own."""
    return layout.header and layout.delimiter == WHITESPACE and len(cells) > 1 and cells[0] in MARKS


def _is_left_out(cells: list[str], layout: TextLayout, width: int) -> bool:
    """Whether a line that has another number of cells is no row."""
    ends = len(cells) == width + 1 and not cells[-1]
    return not ends and bool(layout.ragged or (layout.prose and not any(map(_is_counted, cells))))


def _is_counted(cell: str) -> bool:
    """Whether a cell begins as a number does."""
    return cell.lstrip("+-.")[:1].isdigit()


UTF_8 = "save it as CSV UTF-8, or read it through a mapping, which `nxt-twin map` writes"


def _all_lines(path: Path, layout: TextLayout) -> Generator[NumberedLine]:
    """Every line that is not blank."""
    try:
        with path.open(encoding=layout.encoding, newline="") as file:
            skipped = sum(1 for _ in islice(file, layout.skip))
            if layout.delimiter == WHITESPACE:
                yield from ((n, text.split()) for n, text in enumerate(file, skipped + 1) if text.strip())
                return
            reader = csv.reader(file, delimiter=layout.delimiter)
            for cells in reader:
                stripped = [cell.strip() for cell in cells]
                if stripped and stripped != [""]:
                    yield skipped + reader.line_num, stripped
    except UnicodeDecodeError:
        where = f"{path}, row {_first_undecodable_line(path)}"
        raise RecordingError("is not UTF-8 text", where=where, mend=UTF_8) from None
    except csv.Error as failure:
        mend = "look for a quote that never closes"
        raise RecordingError(f"is no text table: {failure}", where=str(path), mend=mend) from None


def first_line(lines: Iterator[NumberedLine], path: Path) -> NumberedLine:
    """Take the first line.

    Raises:
        RecordingError: if there is none.
    """
    for line in lines:
        return line
    raise RecordingError("holds nothing but blanks", where=str(path), mend="check that it is the right file")


def column_names(first: NumberedLine, layout: TextLayout) -> list[str]:
    """The names in the first line, or c1, c2, … where the layout has no header."""
    if not layout.header:
        return [f"c{number}" for number in range(1, len(first[1]) + 1)]
    name, *others = first[1]
    return [name.lstrip("#").strip() or name, *others]


def read_lines(path: Path, layout: TextLayout, choose: Choose) -> Table:
    """Read a table in which each line is a row.

    Raises:
        RecordingError: for a ragged line, or a cell that is no finite number where one is due.
    """
    lines = iterate_lines(path, layout)
    first = first_line(lines, path)
    names = column_names(first, layout)
    wanted = choose(names)
    numbers = {name: array("d") for name, kind in wanted.items() if kind == "number"}
    words: dict[str, list[str]] = {name: [] for name, kind in wanted.items() if kind != "number"}
    position = {name: names.index(name) for name in wanted}
    body = lines if layout.header else chain([first], lines)
    if layout.units_row:
        next(body, None)
    for number, cells in body:
        if layout.delimiter != WHITESPACE and len(cells) == len(names) + 1 and not cells[-1]:
            cells = cells[:-1]  # a delimiter ends the line, as some programs write it
        if len(cells) != len(names):
            what = f"has {len(cells)} cells where there are {len(names)} columns"
            mend = "complete or delete the row, or write `table: {ragged: skip}` in a mapping"
            raise RecordingError(what, where=f"{path}, row {number}", mend=mend)
        for name, values in numbers.items():
            values.append(_number(cells[position[name]], layout, (path, number, name)))
        for name, texts in words.items():
            texts.append(cells[position[name]])
    return Table(
        numbers={name: np.array(values, dtype=np.float64) for name, values in numbers.items()},
        words={name: tuple(texts) for name, texts in words.items()},
        place=lambda index, column: place_in_lines(path, layout, index, column),
    )


def read_transposed(path: Path, layout: TextLayout, choose: Choose) -> Table:
    """Read a table in which each line is a column of numbers.

    Raises:
        RecordingError: for lines of unequal length, or a cell that is no finite number.
    """
    cells_of: dict[str, tuple[int, list[str]]] = {}
    names: list[str] = []
    lines = iterate_lines(path, layout)
    for number, cells in chain([first_line(lines, path)], lines):
        names.append(cells[0] if layout.header else f"c{len(names) + 1}")
        cells_of[names[-1]] = (number, cells[1:] if layout.header else cells)
    wanted = choose(names)
    numbers: dict[str, FloatArray] = {}
    words = {name: tuple(cells_of[name][1]) for name, kind in wanted.items() if kind != "number"}
    for name in (name for name, kind in wanted.items() if kind == "number"):
        number, cells = cells_of[name]
        values = [_number(cell, layout, (path, number, name)) for cell in cells]
        numbers[name] = np.array(values, dtype=np.float64)
        if len(cells) != len(numbers[next(iter(numbers))]):
            what = f"has {len(cells)} values, unlike the other columns' lines"
            raise RecordingError(what, where=f"{path}, row {number}", mend="give each line as many values")
    return Table(
        numbers=numbers,
        words=words,
        place=lambda index, name: f"{path}, row {cells_of[name][0]}, value {index + 1}, column {name}",
    )


def place_in_lines(path: Path, layout: TextLayout, index: int, column: str) -> str:
    """The place of a row's cell, with the line as an editor counts it."""
    number, _ = next(islice(iterate_lines(path, layout), index + layout.head_lines, None))
    return f"{path}, row {number}, column {column}"


def _number(text: str, layout: TextLayout, cell: Cell) -> float:
    if text in layout.empty:
        return math.nan
    try:
        bare = text.replace(layout.thousands, "") if layout.thousands else text
        value = math.nan if "_" in text else float(bare.replace(layout.decimal, "."))
    except ValueError:
        raise RecordingError(
            f"{quoted(text)} is no number", where=_place(cell), mend=_marks(text, layout)
        ) from None
    if not math.isfinite(value):
        raise RecordingError(f"{quoted(text)} is no finite number", where=_place(cell), mend=_LEAVE_EMPTY)
    return value


def _marks(text: str, layout: TextLayout) -> str:
    """What mends a cell that is no number: the marks in it may be others than the layout's."""
    if _UNITED.fullmatch(text):
        return "write the number alone; its unit belongs into the mapping or the column's name"
    decimal, other = layout.decimal, "," if layout.decimal == "." else "."
    if other in text and (decimal in text or decimal == ","):
        return f'write `table: {{thousands: "{other}"}}` in a mapping'
    return f'write `table: {{decimal: "{other}"}}` in a mapping' if other in text else _LEAVE_EMPTY


def _place(cell: Cell) -> str:
    path, line, column = cell
    return f"{path}, row {line}, column {column}"


def _first_undecodable_line(path: Path) -> int:
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            try:
                line.decode("utf-8")
            except UnicodeDecodeError:
                return number
    return 1
