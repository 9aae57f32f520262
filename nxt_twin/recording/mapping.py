"""Mapping files: what the columns of a table from elsewhere are (docs/formats.md#mapping-files)."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from pathlib import Path
from typing import Annotated, Any, Literal, Self, final

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from nxt_twin.errors import MappingError
from nxt_twin.recording.checks import LONGEST_GAP_S
from nxt_twin.recording.columns import DriveMode
from nxt_twin.recording.recording import InputKind, OutputKind
from nxt_twin.recording.source import quoted
from nxt_twin.recording.tables.content import TableKind
from nxt_twin.recording.tables.lines import WHITESPACE
from nxt_twin.recording.tables.nested import with_index
from nxt_twin.recording.yaml_file import read_model, read_part

TimeUnit = Literal["s", "ms", "us", "ns", "iso", "clock"]
LINEAR_OUTPUTS: tuple[OutputKind, ...] = ("position_m", "speed_m_per_s")
POWER_LIMIT_PCT = 100.0

_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, coerce_numbers_to_str=True)


@final
class TableFormat(BaseModel):
    """The file's format. The file's content gives each key that is left out.

    Attributes:
        format: what the file is.
        delimiter: of a text file: one character, or `whitespace` for runs of blanks.
        header: whether a text file names its columns; if not, they are c1, c2, ….
        transposed: whether each line of a text file is a column.
        decimal: the mark between whole and fraction.
        thousands: the mark between thousands, where there is one.
        lines: what each line of the file is, where it is no row of cells.
        ragged: what becomes of lines that have another number of cells; without it they are refused.
        skip: how many lines come before the header.
        units_row: whether the line below the header holds units.
        encoding: of a text file.
    """

    model_config = _STRICT

    format: TableKind | None = None
    delimiter: str | None = None
    header: bool | None = None
    transposed: bool | None = None
    decimal: Literal[".", ","] | None = None
    thousands: Literal[".", ",", " ", "'"] | None = None
    lines: Literal["json", "labels"] | None = None
    ragged: Literal["skip"] | None = None
    skip: int | None = Field(default=None, ge=0)
    units_row: bool | None = None
    encoding: Literal["utf-8", "utf-16", "cp1252", "latin-1"] | None = None

    @model_validator(mode="after")
    def _delimiter_is_one_character(self) -> Self:
        mark = self.delimiter
        if mark is not None and mark != WHITESPACE and (len(mark) != 1 or mark in '"\r\n\0'):
            raise ValueError(f"delimiter {quoted(mark)} is neither one character nor {WHITESPACE}")
        return self


@final
class TimeSource(BaseModel):
    """A column of stamps, or a constant period.

    Attributes:
        column: of the stamps.
        unit: of the stamps. `iso`: dates as ISO 8601; `clock`: text that holds hh:mm:ss.
        period_s: the constant period, s.
        wraps_at: the value at which the stamps start anew, in their own unit; they are unwrapped.
        sort: rows are to be put in the order of their stamps.
    """

    model_config = _STRICT

    column: str | None = None
    unit: TimeUnit = "s"
    period_s: float | None = Field(default=None, gt=0.0, le=LONGEST_GAP_S)
    wraps_at: float | None = Field(default=None, gt=0.0)
    sort: bool = False

    @model_validator(mode="after")
    def _column_or_period(self) -> Self:
        if (self.column is None) == (self.period_s is None):
            raise ValueError("name either a column or a period_s")
        if self.sort and self.wraps_at is not None:
            raise ValueError("stamps that start anew cannot be sorted: keep wraps_at or sort")
        return self


@final
class SignSource(BaseModel):
    """A column that tells a command's direction: `values: {0: 1, 1: -1}`."""

    model_config = _STRICT

    column: str
    values: dict[str, Literal[-1, 0, 1]] = Field(min_length=1)


@final
class InputSource(BaseModel):
    """A column, or a constant value, that is `kind` once multiplied by `gain` and moved by `offset`.

    A value may differ by file: `value: {"*_20_*": 20, "*_40_*": 40}`. A column without a sign may have one beside it,
    as drivers with a pin for the direction do. Goals that start anew at a value (`wraps_at`, in the column's unit)
    are taken in the turn in which the reading is. Both columns then need one unit.
    """

    model_config = _STRICT

    column: str | None = None
    value: float | dict[str, float] | None = None
    kind: InputKind
    gain: float = 1.0
    offset: float = 0.0
    sign: SignSource | None = None
    wraps_at: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _column_or_value(self) -> Self:
        if (self.column is None) == (self.value is None):
            raise ValueError("name either a column or a value")
        values = self.value.values() if isinstance(self.value, dict) else (self.value or 0.0,)
        for value in values:
            if self.kind == "power_pct" and abs(value) > POWER_LIMIT_PCT:
                raise ValueError(f"value {value:g} is outside -100 to 100 %")
        return self


@final
class OutputSource(BaseModel):
    """A column that is `kind` once multiplied by `gain` and moved by `offset`.

    Attributes:
        step: the smallest step of the reading, in the unit of `kind`.
        quantum: that of the column, in the column's own unit. Where both are left out, it is 1 if the column
            holds whole numbers only, and otherwise 0.
        wraps_at: the value at which the column starts anew, in its own unit; it is unwrapped.
    """

    model_config = _STRICT

    column: str
    kind: OutputKind
    gain: float = 1.0
    offset: float = 0.0
    step: float | None = Field(default=None, ge=0.0)
    quantum: float | None = Field(default=None, ge=0.0)
    wraps_at: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _one_step(self) -> Self:
        if self.step is not None and self.quantum is not None:
            raise ValueError("give either a step (of the reading) or a quantum (of the column)")
        return self


@final
class SupplySource(BaseModel):
    """A column that is the supply voltage once multiplied by `gain` and moved by `offset`."""

    model_config = _STRICT

    column: str
    kind: Literal["voltage_v"] = "voltage_v"
    gain: float = 1.0
    offset: float = 0.0


@final
class ModeSource(BaseModel):
    """A column whose values say what the bridge does: `values: {0: coast, 1: drive}`.

    A mapping may list several such columns. The first one whose value is not `drive` decides.
    """

    model_config = _STRICT

    column: str
    values: dict[str, DriveMode] = Field(min_length=1)


@final
class JointSource(BaseModel):
    """A column that is the angle of another joint of the arm.

    Attributes:
        kind: what the column holds.
        sign: by how much its angle adds to that of the joint in question, counted from the arm's foot. It is 0 for a
            joint further out, which changes the load but not the angle.
    """

    model_config = _STRICT

    column: str
    kind: Literal["position_deg", "position_rad"]
    sign: float = 1.0


@final
class SplitColumn(BaseModel):
    """A column that tells a table's recordings apart: by its values, or (`falls`) by falling where one begins."""

    model_config = _STRICT

    column: str
    falls: bool = False


def _flat(given: Any) -> Any:  # noqa: ANN401  # what a user wrote
    """`column: data, index: 3`, also one inside the other, as the column `data[3]`."""
    if not isinstance(given, dict):
        return given
    if isinstance(given.get("column"), dict):
        given = {**given, **given["column"]}
    if isinstance(given.get("column"), str):
        given = {**given, "column": with_index(given["column"])}
    if "index" not in given:
        return given
    index = given["index"]
    if not isinstance(index, int) or isinstance(index, bool) or index < 0:
        raise ValueError(f"index {quoted(index)} is no whole number from 0 on")
    rest = {key: value for key, value in given.items() if key != "index"}
    return {**rest, "column": f"{given.get('column')}[{index}]"}


FLAT = BeforeValidator(_flat)
"""Lets a column be written with an index of its own."""


def _flat_list(given: Any) -> Any:  # noqa: ANN401  # what a user wrote
    """One column or a list of columns, as a list."""
    if given is None:
        return ()
    return [_flat(each) for each in (given if isinstance(given, list | tuple) else [given])]


def with_split_of_table(given: Any) -> Any:  # noqa: ANN401  # what a user wrote
    """`table: {split: …}` is as good as `split: …`."""
    table = given.get("table") if isinstance(given, dict) else None
    if not isinstance(table, dict) or "split" not in table:
        return given
    rest = {key: value for key, value in table.items() if key != "split"}
    return {**given, "table": rest, "split": table["split"]}


@final
class Mapping(BaseModel):
    """A whole mapping file of one motor, joint or bench."""

    model_config = _STRICT

    table: TableFormat = TableFormat()
    time: Annotated[TimeSource, FLAT]
    input: Annotated[InputSource, FLAT]
    output: Annotated[OutputSource, FLAT]
    supply: Annotated[SupplySource | None, FLAT] = None
    mode: Annotated[tuple[ModeSource, ...], BeforeValidator(_flat_list)] = ()
    split: Annotated[SplitColumn | None, FLAT] = None
    gravity_of: dict[str, Annotated[JointSource, FLAT]] = {}

    @model_validator(mode="before")
    @classmethod
    def _split_in_table(cls, given: Any) -> Any:  # noqa: ANN401  # what a user wrote
        return with_split_of_table(given)

    @model_validator(mode="after")
    def _gravity_turns_an_angle(self) -> Self:
        if self.gravity_of and self.output.kind not in ("position_deg", "position_rad"):
            raise ValueError("gravity_of needs an output of kind position_deg or position_rad")
        return self

    @model_validator(mode="after")
    def _input_can_drive_output(self) -> Self:
        linear = self.output.kind in LINEAR_OUTPUTS
        if self.input.kind == ("torque_nm" if linear else "force_n"):
            raise ValueError(f"a {self.input.kind} does not drive a {self.output.kind}; check the two kinds")
        return self


def read_mapping(path: Path) -> Mapping:
    """Read a mapping file.

    Raises:
        MappingError: if it is no YAML, or has an unknown key, kind or unit, or lacks one that is needed.
    """
    return read_model(path, Mapping, MappingError)


def mapping_of(keys: MappingType[str, Any], where: str) -> Mapping:
    """A mapping from its keys, `where` being the place that a refusal names.

    Raises:
        MappingError: as `read_mapping`.
    """
    return read_part(dict(keys), Mapping, MappingError, where=where)
