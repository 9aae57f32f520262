"""A table in memory, with the way back to the place in its file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, final

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError

CellKind = Literal["number", "word", "label"]
"""What a column's cells are: numbers, text, or either taken as text."""
Choose = Callable[[Sequence[str]], Mapping[str, CellKind]]
"""Given the names of all columns in a file, says which to read and as what, or refuses them."""

LARGEST_CELLS = 64 * 2**20
"""What a compressed file may unfold to: 512 MiB of float64."""
_ANY_FILE_CELLS = 2**20
_CELLS_PER_BYTE = 32
"""A recording packs by a few times; one that unfolds beyond this was made to fill the memory."""


def cells_allowed(path: Path) -> int:
    """How many cells a compressed file may unfold to, by its size."""
    return min(LARGEST_CELLS, _ANY_FILE_CELLS + _CELLS_PER_BYTE * path.stat().st_size)


def check_unfolded(cells: int, path: Path) -> None:
    """Refuse a compressed file that unfolds to too many cells.

    Raises:
        RecordingError: it does.
    """
    allowed = cells_allowed(path)
    if cells > allowed:
        what = f"unfolds to {cells} cells, more than the {allowed} that a file of its size may hold"
        raise RecordingError(what, where=str(path), mend="split it into shorter recordings")


@final
@dataclass(frozen=True)
class Table:
    """The chosen columns of one file.

    Attributes:
        numbers: by column, shape (rows,); NaN is an empty cell.
        words: by column, one a row; the empty string is an empty cell.
        place: from a row's index and a column's name to the place in the file, in words.
    """

    numbers: Mapping[str, FloatArray]
    words: Mapping[str, tuple[str, ...]]
    place: Callable[[int, str], str]
