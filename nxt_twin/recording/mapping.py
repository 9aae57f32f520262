"""Mapping files: what the columns of a table from elsewhere are (docs/formats.md#mapping-files)."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from collections.abc import Sequence
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import Literal, Self, final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import MappingError, RecordingError
from nxt_twin.recording.checks import (
    LONGEST_GAP_S,
    check_finite,
    check_gaps,
    check_range,
    check_row_count,
    check_stamps,
    hold,
)
from nxt_twin.recording.recording import InputKind, OutputKind, Recording, SignalKinds
from nxt_twin.recording.source import nearest, quoted
from nxt_twin.recording.tables.lines import WHITESPACE, TextLayout
from nxt_twin.recording.tables.mat import read_mat
from nxt_twin.recording.tables.parquet import read_parquet
from nxt_twin.recording.tables.table import CellKind, Choose, Table
from nxt_twin.recording.tables.text import read_text
from nxt_twin.recording.yaml_file import read_model

_SECONDS: MappingType[str, float] = MappingProxyType({"s": 1.0, "ms": 1e-3, "us": 1e-6})
_SI: MappingType[OutputKind, tuple[OutputKind, float]] = MappingProxyType(
    {
        "position_deg": ("position_rad", pi / 180.0),
        "speed_deg_per_s": ("speed_rad_per_s", pi / 180.0),
        "position_rad": ("position_rad", 1.0),
        "speed_rad_per_s": ("speed_rad_per_s", 1.0),
        "position_m": ("position_m", 1.0),
        "speed_m_per_s": ("speed_m_per_s", 1.0),
    }
)
_LINEAR_OUTPUTS = ("position_m", "speed_m_per_s")
_POWER_LIMIT_PCT = 100.0


_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, coerce_numbers_to_str=True)


@final
class TableFormat(BaseModel):
    """The file's format.

    Attributes:
        delimiter: of a text file: one character, or `whitespace` for runs of blanks.
        header: whether a text file names its columns; if not, they are c1, c2, ….
        transposed: whether each line of a text file is a column.
    """

    model_config = _STRICT

    format: Literal["csv", "parquet", "mat"] = "csv"
    delimiter: str = ","
    header: bool = True
    transposed: bool = False

    @model_validator(mode="after")
    def _delimiter_is_one_character(self) -> Self:
        if self.delimiter != WHITESPACE and (len(self.delimiter) != 1 or self.delimiter in '"\r\n\0'):
            raise ValueError(f"delimiter {quoted(self.delimiter)} is neither one character nor {WHITESPACE}")
        return self


@final
class TimeSource(BaseModel):
    """A column of stamps in `unit`, or a constant period, s."""

    model_config = _STRICT

    column: str | None = None
    unit: Literal["s", "ms", "us"] = "s"
    period_s: float | None = Field(default=None, gt=0.0, le=LONGEST_GAP_S)

    @model_validator(mode="after")
    def _column_or_period(self) -> Self:
        if (self.column is None) == (self.period_s is None):
            raise ValueError("name either a column or a period_s")
        return self


@final
class InputSource(BaseModel):
    """A column, or a constant value, that is `kind` once multiplied by `gain` and moved by `offset`."""

    model_config = _STRICT

    column: str | None = None
    value: float | None = None
    kind: InputKind
    gain: float = 1.0
    offset: float = 0.0

    @model_validator(mode="after")
    def _column_or_value(self) -> Self:
        if (self.column is None) == (self.value is None):
            raise ValueError("name either a column or a value")
        if self.kind == "power_pct" and abs(self.value or 0.0) > _POWER_LIMIT_PCT:
            raise ValueError(f"value {self.value:g} is outside -100 to 100 %")
        return self


@final
class OutputSource(BaseModel):
    """A column that is `kind` once multiplied by `gain` and moved by `offset`.

    Attributes:
        quantum: the smallest step of the column, in the column's own unit. Left out, it is 1 if the column
            holds whole numbers only, and otherwise 0.
    """

    model_config = _STRICT

    column: str
    kind: OutputKind
    gain: float = 1.0
    offset: float = 0.0
    quantum: float | None = Field(default=None, ge=0.0)


@final
class SupplySource(BaseModel):
    """A column that is the supply voltage once multiplied by `gain` and moved by `offset`."""

    model_config = _STRICT

    column: str
    kind: Literal["voltage_v"] = "voltage_v"
    gain: float = 1.0
    offset: float = 0.0


@final
class Mapping(BaseModel):
    """A whole mapping file."""

    model_config = _STRICT

    table: TableFormat = TableFormat()
    time: TimeSource
    input: InputSource
    output: OutputSource
    supply: SupplySource | None = None

    @model_validator(mode="after")
    def _input_can_drive_output(self) -> Self:
        linear = self.output.kind in _LINEAR_OUTPUTS
        if self.input.kind == ("torque_nm" if linear else "force_n"):
            raise ValueError(f"a {self.input.kind} does not drive a {self.output.kind}; check the two kinds")
        return self


def read_mapping(path: Path) -> Mapping:
    """Read a mapping file.

    Raises:
        MappingError: if it is no YAML, or has an unknown key, kind or unit, or lacks one that is needed.
    """
    return read_model(path, Mapping, MappingError)


def read_mapped(path: Path, mapping: Mapping) -> Recording:
    """Read a table from elsewhere as a recording with the columns `time_s`, `input`, `output` and `supply_v`.

    All are SI but for a `power_pct` input. Inputs that a row leaves empty are filled in with the one in
    force, 0 before the first; outputs and supply are NaN where not sampled.

    Raises:
        MappingError: if the table lacks a mapped column.
        RecordingError: if the table cannot be read, or its stamps or values cannot be a recording's.
    """
    table = _read_table(path, mapping)
    output = table.numbers[mapping.output.column]
    rows = output.size
    check_row_count(rows, path)
    if np.isnan(output).all():
        mend = "map the column that was measured"
        raise RecordingError("is empty", where=f"{path}, column {mapping.output.column}", mend=mend)
    for name, values in table.numbers.items():
        check_finite(table, name, values)
    output_kind, to_si = _SI[mapping.output.kind]
    columns = {
        "time_s": _time_s(table, mapping.time, rows),
        "input": _input(table, mapping.input, rows),
        "output": (output * mapping.output.gain + mapping.output.offset) * to_si,
    }
    if mapping.supply is not None:
        supply = table.numbers[mapping.supply.column]
        columns["supply_v"] = supply * mapping.supply.gain + mapping.supply.offset
    return Recording(
        name=path.name,
        columns=columns,
        kinds=SignalKinds(mapping.input.kind, output_kind),
        output_quantum=_quantum(output, mapping.output) * to_si,
    )


def _read_table(path: Path, mapping: Mapping) -> Table:
    parts = (mapping.time, mapping.input, mapping.output, mapping.supply)
    wanted = [part.column for part in parts if part is not None and part.column is not None]

    def choose(found: Sequence[str]) -> MappingType[str, CellKind]:
        for name in wanted:
            if found.count(name) != 1:
                count = "no column" if name not in found else "more than one column"
                mend = f"nearest known: {nearest(name, found)}" if name not in found else "rename one"
                raise MappingError(f"has {count} {quoted(name)}", where=str(path), mend=mend)
        return dict.fromkeys(wanted, "number")

    return _open(path, mapping.table, choose)


def _open(path: Path, table: TableFormat, choose: Choose) -> Table:
    match table.format:
        case "csv":
            return read_text(path, TextLayout(table.delimiter, table.header, table.transposed), choose)
        case "parquet":
            return read_parquet(path, choose)
        case "mat":
            return read_mat(path, choose)


def _time_s(table: Table, source: TimeSource, rows: int) -> FloatArray:
    if source.column is None:
        return np.arange(rows, dtype=np.float64) * (source.period_s or 0.0)
    check_stamps(table, source.column)
    time_s: FloatArray = table.numbers[source.column] * _SECONDS[source.unit]
    check_gaps(table, source.column, time_s)
    return time_s


def _input(table: Table, source: InputSource, rows: int) -> FloatArray:
    if source.column is None:
        return np.full(rows, (source.value or 0.0) * source.gain + source.offset)
    values = hold(table.numbers[source.column] * source.gain + source.offset)
    if source.kind == "power_pct":
        check_range(table, source.column, values, -_POWER_LIMIT_PCT, _POWER_LIMIT_PCT)
    return values


def _quantum(output: FloatArray, source: OutputSource) -> float:
    """The output's smallest step in the unit of its kind."""
    if source.quantum is not None:
        return source.quantum * abs(source.gain)
    sampled = output[~np.isnan(output)]
    is_counted = bool(np.all(sampled == np.rint(sampled))) and sampled.min() < sampled.max()
    return abs(source.gain) if is_counted else 0.0
