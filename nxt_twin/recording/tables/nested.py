"""Columns within columns: the elements of a matrix or list as `data[3]`, the fields of a struct as `log.speed`."""

from __future__ import annotations

import re
from collections.abc import Sequence

import pyarrow as pa
from numpy.typing import NDArray

_CUT = re.compile(r"\[\s*:\s*,\s*(\d+)\s*\]")
MOST_ELEMENTS = 256
"""A matrix or list with more is no table."""


def element_names(name: str, shape: tuple[int, ...]) -> list[str]:
    """The columns of a matrix by name, along its shorter side; none of a vector or of what is no table."""
    if len(shape) != 2 or min(shape) < 2 or min(shape) > MOST_ELEMENTS:
        return []
    return [f"{name}[{index}]" for index in range(min(shape))]


def element(matrix: NDArray, index: int) -> NDArray:  # type: ignore[type-arg]  # of any numbers
    """Column `index` of a matrix, along its shorter side."""
    return matrix[:, index] if matrix.shape[1] <= matrix.shape[0] else matrix[index]


def innermost(names: Sequence[str]) -> list[str]:
    """The names without those whose elements or fields are named too."""
    outer = {
        stem for name in names for stem in (split_name(name)[0], name.rpartition(".")[0]) if stem != name
    }
    return [name for name in names if name not in outer]


def with_index(name: str) -> str:
    """`data[:, 3]`, as numpy and MATLAB cut a column out, as `data[3]`."""
    return _CUT.sub(r"[\1]", name)


def split_name(name: str) -> tuple[str, int | None]:
    """`data[3]` as `data` and 3; a name without an index has None."""
    if not name.endswith("]") or "[" not in name:
        return name, None
    stem, _, index = name[:-1].rpartition("[")
    return (stem, int(index)) if index.isdigit() else (name, None)


def arrow_names(table: pa.Table) -> list[str]:
    """The names of all columns of a table or of its first rows, each list with its elements after it."""
    names: list[str] = []
    for field in table.schema:
        names.append(field.name)
        names += (
            [f"{field.name}.{inner.name}" for inner in field.type] if pa.types.is_struct(field.type) else []
        )
        names += [f"{field.name}[{index}]" for index in range(_elements(table[field.name]))]
    return names


def arrow_column(table: pa.Table, name: str) -> pa.ChunkedArray:
    """One of a table's columns by a name that `arrow_names` gave."""
    if name in table.column_names:
        return table[name]
    import pyarrow.compute as pc  # slow, and plain columns need none of it

    stem, index = split_name(name)
    if index is not None:
        return pc.list_element(table[stem], index)
    struct, _, inner = name.partition(".")
    return pc.struct_field(table[struct], inner)


def arrow_stem(name: str, stored: list[str]) -> str:
    """The stored column that holds the one of this name."""
    if name in stored:
        return name
    stem, index = split_name(name)
    return stem if index is not None else name.partition(".")[0]


def _elements(column: pa.ChunkedArray) -> int:
    kind = column.type
    if pa.types.is_fixed_size_list(kind):
        size = int(kind.list_size)
    elif pa.types.is_list(kind) or pa.types.is_large_list(kind):
        import pyarrow.compute as pc

        size = int(pc.min(pc.list_value_length(column)).as_py() or 0)
    else:
        return 0
    return size if size <= MOST_ELEMENTS else 0
