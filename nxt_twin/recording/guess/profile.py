"""All columns of a table, as far as they are numbers, with what their names say."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_head
from nxt_twin.recording.tables.content import TableKind, kind_of, text_layout
from nxt_twin.recording.tables.lines import TextLayout, iterate_lines
from nxt_twin.recording.tables.mat import read_vectors
from nxt_twin.recording.tables.nested import innermost, split_name
from nxt_twin.recording.tables.open import read_table, table_file
from nxt_twin.recording.tables.table import CellKind

ISO = "iso"
_WORDS = re.compile(r"[A-Z]?[a-zäöü°µ]+|[A-Z]+(?![a-zäöü])|\d+|%")
_BRACKETED = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]")
_TRUTHS = {"true": "1", "false": "0"}
_LARGEST_INFO_BYTES = 2**20
_FEW_WORDS = 8
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
    """

    name: str
    values: FloatArray
    stated_unit: str = ""
    joint: str = ""

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
    """

    path: Path
    kind: TableKind
    layout: TextLayout | None
    columns: tuple[TableColumn, ...]
    others: Mapping[str, tuple[str, ...]]

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
    layout = text_layout(file, {}) if kind == "csv" else None
    words = {} if kind == "mat" else _read(file, kind)
    cells = {name: _as_numbers(own) for name, own in words.items()}
    dates = {name: _as_dates(words[name]) for name, values in cells.items() if values is None}
    cells |= read_vectors(file) if kind == "mat" else dates
    numbers = {name: values for name, values in cells.items() if values is not None}
    if not numbers:
        mend = "write `table: {delimiter: …, header: …}` in a mapping"
        raise RecordingError("holds no column of numbers", where=str(file), mend=mend)
    rows = Counter(values.size for values in numbers.values() if values.size > 1).most_common(1)
    numbers = {name: values for name, values in numbers.items() if rows and values.size == rows[0][0]}
    units = _units(file, layout, list(cells)) | {name: ISO for name, own in dates.items() if own is not None}
    joints = _joints(file)
    columns = (TableColumn(n, v, units.get(n, _bracketed(n)), joints.get(n, "")) for n, v in numbers.items())
    others = {name: _few(words[name]) for name, values in cells.items() if values is None}
    return TableProfile(file, kind, layout, tuple(columns), others)


def _few(cells: Sequence[str]) -> tuple[str, ...]:
    """The different words of a column; none where there are many."""
    found = sorted({word for word in cells if word})
    return tuple(found) if len(found) <= _FEW_WORDS else ()


def _read(file: Path, kind: TableKind) -> dict[str, tuple[str, ...]]:
    """Every column as words."""

    def choose(names: Sequence[str]) -> dict[str, CellKind]:
        flat = innermost(names) if kind in ("parquet", "feather") else names
        return dict.fromkeys((name for name in flat if name and names.count(name) == 1), "label")

    return dict(read_table(file, choose, kind, {}).words)


def _as_dates(words: Sequence[str]) -> FloatArray | None:
    """Seconds since 1970; None where some words are no dates."""
    try:
        return np.array([datetime.fromisoformat(word).timestamp() for word in words])
    except ValueError:
        return None


def _as_numbers(words: Sequence[str]) -> FloatArray | None:
    """The numbers that words write; None where some are none, or all are empty."""
    try:
        plain = (_TRUTHS.get(word.lower(), word.replace(",", ".")) or "nan" for word in words)
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
    for folder in list(file.resolve().parents)[:_LEVELS_UP]:
        info = folder / "meta" / "info.json"
        if info.is_file():
            read_head(
                info,
                RecordingError,
                largest_bytes=_LARGEST_INFO_BYTES,
                advice="check that it is a description",
            )
            try:
                features = json.loads(info.read_text(encoding="utf-8"))["features"]
                return {
                    f"{column}[{index}]": str(joint)
                    for column in ("observation.state", "action")
                    for index, joint in enumerate(_listed(features[column]["names"]))
                }
            except (ValueError, KeyError, TypeError, RecursionError):
                return {}
    return {}


def _listed(names: object) -> Sequence[object]:
    """A list of names, also where it stands under a key."""
    if isinstance(names, dict):
        names = next(iter(names.values()))
    return names if isinstance(names, list) else []
