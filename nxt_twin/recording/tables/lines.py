"""Text tables, cell by cell: slow, tolerant of blanks, and exact about where something is wrong."""

from __future__ import annotations

import csv
import math
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

Line = tuple[int, list[str]]


@final
@dataclass(frozen=True)
class TextLayout:
    """How a text file is cut into cells.

    Attributes:
        delimiter: one character, or `whitespace` for runs of blanks.
        header: whether the first line names the columns; without, they are c1, c2, …
        transposed: whether each line is a column, named by its first cell if there is a header.
    """

    delimiter: str = ","
    header: bool = True
    transposed: bool = False


def iterate_lines(path: Path, layout: TextLayout) -> Generator[Line]:
    """Yield the number (from 1) and the stripped cells of every line that is not blank, header included.

    Raises:
        RecordingError: if the text is not UTF-8 or its quotes never close.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            if layout.delimiter == WHITESPACE:
                yield from ((number, text.split()) for number, text in enumerate(file, 1) if text.strip())
                return
            reader = csv.reader(file, delimiter=layout.delimiter)
            for cells in reader:
                stripped = [cell.strip() for cell in cells]
                if stripped and stripped != [""]:
                    yield reader.line_num, stripped
    except UnicodeDecodeError:
        where = f"{path}, row {_first_undecodable_line(path)}"
        raise RecordingError("is not UTF-8 text", where=where, mend="save it as CSV UTF-8") from None
    except csv.Error as failure:
        mend = "look for a quote that never closes"
        raise RecordingError(f"is no text table: {failure}", where=str(path), mend=mend) from None


def first_line(lines: Iterator[Line], path: Path) -> Line:
    """Take the first line.

    Raises:
        RecordingError: if there is none.
    """
    for line in lines:
        return line
    raise RecordingError("holds nothing but blanks", where=str(path), mend="check that it is the right file")


def column_names(first: Line, layout: TextLayout) -> list[str]:
    """The names in the first line, or c1, c2, … where the layout has no header."""
    return first[1] if layout.header else [f"c{number}" for number in range(1, len(first[1]) + 1)]


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
    words: dict[str, list[str]] = {name: [] for name, kind in wanted.items() if kind == "word"}
    position = {name: names.index(name) for name in wanted}
    body = lines if layout.header else chain([first], lines)
    for number, cells in body:
        if len(cells) != len(names):
            what = f"has {len(cells)} cells where there are {len(names)} columns"
            raise RecordingError(what, where=f"{path}, row {number}", mend="complete or delete the row")
        for name, values in numbers.items():
            values.append(_number(cells[position[name]], path, number, name))
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
    for name in wanted:
        number, cells = cells_of[name]
        numbers[name] = np.array([_number(cell, path, number, name) for cell in cells], dtype=np.float64)
        if len(cells) != len(numbers[next(iter(wanted))]):
            what = f"has {len(cells)} values, unlike the other columns' lines"
            raise RecordingError(what, where=f"{path}, row {number}", mend="give each line as many values")
    return Table(
        numbers=numbers,
        words={},
        place=lambda index, name: f"{path}, row {cells_of[name][0]}, value {index + 1}, column {name}",
    )


def place_in_lines(path: Path, layout: TextLayout, index: int, column: str) -> str:
    """The place of a row's cell, with the line as an editor counts it."""
    skipped = 1 if layout.header else 0
    number, _ = next(islice(iterate_lines(path, layout), index + skipped, None))
    return f"{path}, row {number}, column {column}"


def _number(text: str, path: Path, line: int, column: str) -> float:
    if not text:
        return math.nan
    where = f"{path}, row {line}, column {column}"
    mend = "leave the cell empty where nothing was sampled"
    try:
        value = math.nan if "_" in text else float(text)
    except ValueError:
        raise RecordingError(f"{quoted(text)} is no number", where=where, mend=mend) from None
    if not math.isfinite(value):
        what = f"{quoted(text)} is no finite number"
        raise RecordingError(what, where=where, mend=mend)
    return value


def _first_undecodable_line(path: Path) -> int:
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            try:
                line.decode("utf-8")
            except UnicodeDecodeError:
                return number
    return 1
