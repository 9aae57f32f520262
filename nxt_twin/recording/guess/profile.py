"""All columns of a table, as far as they are numbers, with what their names say."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.clock import clock_s, past_midnight
from nxt_twin.recording.tables.content import TableKind, kind_of, text_layout
from nxt_twin.recording.tables.lerobot import is_data_set, joints_of
from nxt_twin.recording.tables.lines import TextLayout, column_names, first_line, iterate_lines
from nxt_twin.recording.tables.mat import read_vectors
from nxt_twin.recording.tables.nested import innermost, split_name
from nxt_twin.recording.tables.open import read_table, table_file
from nxt_twin.recording.tables.table import CellKind

ISO, CLOCK = "iso", "clock"
_WORDS = re.compile(r"[A-Z]?[a-zäöü°µ]+|[A-Z]+(?![a-zäöü])|\d+|%")
_BRACKETED = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]")
_TRUTHS = {"true": "1", "false": "0"}
_FEW_WORDS = 8
_SWITCHED = 2
_FEWEST_ROWS = 2
_LEVELS_UP = 4  # from a LeRobot episode to its data set's meta/info.json


@final
@dataclass(frozen=True)
class TableColumn:
    """One column.

    Attributes:
        name: its full name.
        values: shape (rows,); NaN is an empty cell.
        stated_unit: what a row of units, or brackets in the name, state.
        joint: the joint that it is of, where the data set's description names it.
        labels: the words that 0, 1 and so on stand for, of a column of words.
    """

    name: str
    values: FloatArray
    stated_unit: str = ""
    joint: str = ""
    labels: tuple[str, ...] = ()

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The words of its name and joint, in small letters."""
        bare = _BRACKETED.sub(" ", split_name(self.name)[0])
        return tuple(word.lower() for word in _WORDS.findall(f"{bare} {self.joint}"))

    @cached_property
    def index(self) -> int | None:
        """Which element of a list or matrix it is."""
        return split_name(self.name)[1]

    @property
    def keys(self) -> dict[str, Any]:
        """How a mapping names it."""
        stem, index = split_name(self.name)
        return {"column": self.name} if index is None else {"column": stem, "index": index}

    @cached_property
    def known(self) -> FloatArray:
        """The values that are there."""
        return self.values[np.isfinite(self.values)]

    @property
    def span(self) -> float:
        """From the least value to the greatest."""
        return float(np.ptp(self.known)) if self.known.size else 0.0

    @property
    def largest(self) -> float:
        """The greatest absolute value."""
        return float(np.abs(self.known).max(initial=0.0))

    @cached_property
    def is_whole(self) -> bool:
        """All values are whole numbers."""
        return bool(np.all(self.known == np.rint(self.known)))


@final
@dataclass(frozen=True)
class TableProfile:
    """A table as it is found.

    Attributes:
        path: the file.
        kind: its format.
        layout: how it is cut into cells, of a text table.
        columns: those of numbers, as many rows each.
        others: the columns that hold none, and the words of those with few different ones.
        twice: names that several columns bear, none of which is read.
        switches: the columns that hold one of two words in each row.
    """

    path: Path
    kind: TableKind
    layout: TextLayout | None
    columns: tuple[TableColumn, ...]
    others: Mapping[str, tuple[str, ...]]
    twice: tuple[str, ...] = ()
    switches: tuple[TableColumn, ...] = ()

    @property
    def rows(self) -> int:
        """How many rows it has."""
        return self.columns[0].values.size if self.columns else 0


def profile_of(path: Path) -> TableProfile:
    """Read all columns of a table.

    Raises:
        RecordingError: it cannot be read as a table, or holds no numbers.
    """
    file = table_file(path)
    kind = kind_of(file)
    layout, words = _words(file, kind)
    thousands = layout.thousands if layout else ""
    cells = {name: _as_numbers(own, thousands) for name, own in words.items()}
    stamps = {name: _as_stamps(words[name]) for name, values in cells.items() if values is None}
    cells |= read_vectors(file) if kind == "mat" else {name: own and own[0] for name, own in stamps.items()}
    numbers = {name: values for name, values in cells.items() if values is not None}
    longest = max((values.size for values in numbers.values()), default=_FEWEST_ROWS)
    if longest < _FEWEST_ROWS:
        held = "only one row" if longest else "no rows"
        raise RecordingError(f"holds {held}", where=str(file), mend="record at least two")
    if not numbers:
        mend = "write `table: {delimiter: …, header: …}` in a mapping"
        raise RecordingError("holds no column of numbers", where=str(file), mend=mend)
    rows = Counter(values.size for values in numbers.values() if values.size > 1).most_common(1)
    numbers = {name: values for name, values in numbers.items() if rows and values.size == rows[0][0]}
    units = _units(file, layout, list(cells)) | {name: own[1] for name, own in stamps.items() if own}
    joints = _joints(file)
    columns = (TableColumn(n, v, units.get(n, _bracketed(n)), joints.get(n, "")) for n, v in numbers.items())
    others = {name: _few(words[name]) for name, values in cells.items() if values is None}
    switches = (
        TableColumn(name, _coded(words[name], own), labels=own)
        for name, own in others.items()
        if len(own) == _SWITCHED
    )
    return TableProfile(file, kind, layout, tuple(columns), others, _twice(file, layout), tuple(switches))


def _twice(file: Path, layout: TextLayout | None) -> tuple[str, ...]:
    """The names that the header of a text table gives to several columns."""
    if layout is None or layout.transposed:
        return ()
    counts = Counter(column_names(first_line(iterate_lines(file, layout), file), layout))
    return tuple(name for name, count in counts.items() if name and count > 1)


def _few(cells: Sequence[str]) -> tuple[str, ...]:
    """The different words of a column; none where there are many."""
    found = sorted({word for word in cells if word})
    return tuple(found) if len(found) <= _FEW_WORDS else ()


def _coded(cells: Sequence[str], labels: tuple[str, ...]) -> FloatArray:
    """The place of each cell's word among the labels; NaN is an empty cell."""
    places = {word: float(place) for place, word in enumerate(labels)}
    return np.array([places.get(cell, np.nan) for cell in cells], dtype=np.float64)


def _words(file: Path, kind: TableKind) -> tuple[TextLayout | None, dict[str, tuple[str, ...]]]:
    """How a text table is cut into cells, and every column as words; lines that do not fit are left out."""
    if kind != "csv":
        return None, {} if kind == "mat" else _read(file, kind, {})
    layout = text_layout(file, {})
    try:
        return layout, _read(file, kind, {})
    except RecordingError:
        try:
            return replace(layout, ragged="skip"), _read(file, kind, {"ragged": "skip"})
        except RecordingError:
            pass
        raise


def _read(file: Path, kind: TableKind, given: Mapping[str, object]) -> dict[str, tuple[str, ...]]:
    """Every column as words."""

    def choose(names: Sequence[str]) -> dict[str, CellKind]:
        flat = _by_index(innermost(names)) if kind in ("parquet", "feather", "lerobot") else names
        return dict.fromkeys((name for name in flat if name and names.count(name) == 1), "label")

    return dict(read_table(file, choose, kind, given).words)


def _by_index(names: Sequence[str]) -> list[str]:
    """The names without those that name an element by its joint; such an element has a name by its index too."""
    return [name for name in names if not name.endswith("]") or split_name(name)[1] is not None]


def _as_stamps(words: Sequence[str]) -> tuple[FloatArray, str] | None:
    """Seconds, and whether words are dates or times of day; None where they are neither."""
    try:
        return np.array([datetime.fromisoformat(word).timestamp() for word in words]), ISO
    except ValueError:
        seconds = [clock_s(word) for word in words]
    known = [second for second in seconds if second is not None]
    return (past_midnight(np.array(known)), CLOCK) if known and len(known) == len(seconds) else None


def _as_numbers(words: Sequence[str], thousands: str) -> FloatArray | None:
    """The numbers that words write; None where some are none, or all are empty."""
    try:
        bare = (word.replace(thousands, "") for word in words) if thousands else words
        plain = (_TRUTHS.get(word.lower(), word.replace(",", ".")) or "nan" for word in bare)
        values = np.array(list(plain), dtype=np.float64)
    except ValueError:
        return None
    return values if np.isfinite(values).any() else None


def _units(file: Path, layout: TextLayout | None, names: list[str]) -> dict[str, str]:
    """What a row of units states of each column."""
    if layout is None or not layout.units_row:
        return {}
    (_, cells), *_ = islice(iterate_lines(file, layout), 1, 2)
    return {name: cell.strip("[]() ") for name, cell in zip(names, cells, strict=False) if cell}


def _bracketed(name: str) -> str:
    """The unit in the last brackets of a name, if there is one."""
    found = [unit for unit in _BRACKETED.findall(name) if not unit.isdigit()]
    return found[-1] if found else ""


def _joints(file: Path) -> dict[str, str]:
    """The joints' names by column, from a LeRobot data set's description."""
    folders = [file, *file.resolve().parents][: _LEVELS_UP + 1]
    return next((joints_of(folder) for folder in folders if is_data_set(folder)), {})
