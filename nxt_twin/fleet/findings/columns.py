"""A fleet's table as arrays: small enough for a million sessions."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.fleet.table import read_columns

_COLUMNS: Final = [
    "unit", "session", "batch", "when", "source", "failure", "error", "verdict", "false_alarm_rate", "tried",
    "parameters", "effects",
]  # fmt: skip
_DAY_MS: Final = 86.4e6
_LEAST_STD: Final = 1e-9
"""Of a value, relative: a fit that claims less is not believed."""


@final
@dataclass(frozen=True)
class ColumnValues:
    """Named values of sessions, shape (values,) each.

    Attributes:
        row: of the session.
        name: index into `names`.
        names: of parameters, or ids of effects.
        parameter: of an effect, the name of the parameter whose value it is; else the name again.
        unit: of each name.
        std: without the doubt of anchors, which is common to all.
    """

    row: IntArray
    name: IntArray
    names: tuple[str, ...]
    parameter: tuple[str, ...]
    unit: tuple[str, ...]
    value: FloatArray
    std: FloatArray


@final
@dataclass(frozen=True)
class Sessions:
    """Sessions that have an answer, sorted by unit, time and name; shape (sessions,) each.

    Attributes:
        unit: index into `units`.
        batch: index into `batches`; -1 where it is not known.
        day: when, in days; NaN where it is not known.
        alarm: the engine's false alarm rate; NaN where it is not known.
        tried: number of effects that were tried.
        table: the rows themselves, for words.
    """

    units: tuple[str, ...]
    batches: tuple[str, ...]
    unit: IntArray
    batch: IntArray
    day: FloatArray
    alarm: FloatArray
    tried: IntArray
    table: pa.Table
    parameters: ColumnValues
    effects: ColumnValues


def read_sessions(path: Path) -> tuple[Sessions, pa.Table]:
    """The sessions with an answer, and the rows of those without.

    Raises:
        FleetError: the file is no fleet's table.
    """
    table = read_columns(path, _COLUMNS)
    failed = pc.is_valid(table["failure"])
    order = [(key, "ascending") for key in ("unit", "when", "session")]
    good = table.filter(pc.invert(failed)).sort_by(order).combine_chunks()
    return _sessions(good), table.filter(failed)


def _sessions(table: pa.Table) -> Sessions:
    unit, units = _codes(table["unit"])
    batch, batches = _codes(table["batch"])
    when = np.asarray(table["when"].cast(pa.int64()).to_numpy(), dtype=np.float64)
    return Sessions(
        units,
        batches,
        unit,
        batch,
        when / _DAY_MS,
        np.asarray(table["false_alarm_rate"].to_numpy(), dtype=np.float64),
        np.asarray(table["tried"].to_numpy(), dtype=np.int64),
        table,
        _parameters(table["parameters"]),
        _effects(table["effects"]),
    )


def _codes(column: pa.ChunkedArray) -> tuple[IntArray, tuple[str, ...]]:
    """The index of each cell in the sorted words; -1 of an empty cell."""
    words = sorted(word for word in pc.unique(column).to_pylist() if word is not None)
    found = pc.index_in(column, value_set=pa.array(words, pa.string()))
    return np.asarray(pc.fill_null(found, -1).to_numpy(), dtype=np.int64), tuple(words)


def _parameters(column: pa.ChunkedArray) -> ColumnValues:
    flat = pc.list_flatten(column)
    return _values(pc.list_parent_indices(column), pc.struct_field(flat, "name"), None, flat)


def _effects(column: pa.ChunkedArray) -> ColumnValues:
    """Each found effect with its first parameter."""
    flat = pc.list_flatten(column)
    own = pc.list_parent_indices(column)
    inner = pc.struct_field(flat, "parameters")
    lengths = np.asarray(pc.list_value_length(inner).to_numpy(), dtype=np.int64)
    first = (np.cumsum(lengths) - lengths)[lengths > 0]
    mask = pa.array(lengths > 0)
    ids = pc.struct_field(flat, "id").filter(mask)
    return _values(own.filter(mask), ids, "name", pc.list_flatten(inner).take(pa.array(first)))


def _values(row: Any, name: Any, parameter: str | None, cells: Any) -> ColumnValues:  # noqa: ANN401 - Arrow's
    codes, names = _codes(name)
    value, std = (
        np.asarray(pc.struct_field(cells, key).to_numpy(), dtype=np.float64) for key in ("value", "own_std")
    )
    known = np.isfinite(value) & np.isfinite(std)
    std = np.maximum(std, _LEAST_STD * np.abs(value)) + np.finfo(float).tiny
    words = [
        np.array(pc.struct_field(cells, key).to_pylist(), dtype=object)
        for key in (parameter or "name", "unit")
    ]
    _, first = np.unique(codes, return_index=True)
    of_name = [tuple(str(each[place] or "") for place in first) for each in words]
    rows = np.asarray(row.to_numpy(), dtype=np.int64)
    return ColumnValues(rows[known], codes[known], names, of_name[0], of_name[1], value[known], std[known])
