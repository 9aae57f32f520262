"""Columns of mixed cells, as JSON and bags give them, turned into a table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.table import Choose, Table

Cells = Sequence[object]


def loose_table(columns: Mapping[str, Cells], path: Path, choose: Choose) -> Table:
    """The chosen of these columns, all of one length; None is an empty cell.

    Raises:
        RecordingError: for a cell that is no finite number where one is due. `choose` may raise its own.
    """
    wanted = choose(list(columns))
    return Table(
        numbers={n: _numbers(columns[n], path, n) for n, kind in wanted.items() if kind == "number"},
        words={n: tuple(map(as_word, columns[n])) for n, kind in wanted.items() if kind != "number"},
        place=lambda index, name: f"{path}, row {index + 1}, column {name}",
    )


def as_word(cell: object) -> str:
    """A cell as a mapping would name it: whole numbers without a point, empty cells as nothing."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    if isinstance(cell, bool):
        return str(cell).lower()
    return f"{cell:.15g}" if isinstance(cell, float) else str(cell).strip()


def _numbers(cells: Cells, path: Path, name: str) -> FloatArray:
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        try:
            values[row] = math.nan if cell is None else float(cell)  # type: ignore[arg-type]  # any cell
        except (TypeError, ValueError, OverflowError):
            where = f"{path}, row {row + 1}, column {name}"
            raise RecordingError(
                f"{quoted(cell)} is no number", where=where, mend="map another column"
            ) from None
    return values
