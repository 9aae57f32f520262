"""A table in memory, with the way back to the place in its file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, final

from nxt_twin.arrays import FloatArray

CellKind = Literal["number", "word"]
Choose = Callable[[Sequence[str]], Mapping[str, CellKind]]
"""Given the names of all columns in a file, says which to read and as what, or refuses them."""

LARGEST_CELLS = 64 * 2**20
"""What a compressed file may unfold to: 512 MiB of float64."""


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
