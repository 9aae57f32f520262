"""Mapping files of robots on two wheels: pose, wheels and powers (docs/formats.md#robots-in-tables-from-elsewhere)."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from math import degrees
from types import MappingProxyType
from typing import Annotated, Any, Literal, Self, final

from pydantic import BaseModel, ConfigDict, Field, model_validator

from nxt_twin.recording.mapping import (
    FLAT,
    SplitColumn,
    SupplySource,
    TableFormat,
    TimeSource,
    with_split_of_table,
)

LengthUnit = Literal["m", "cm", "mm"]
AngleUnit = Literal["deg", "rad", "turn"]

METRES: MappingType[LengthUnit, float] = MappingProxyType({"m": 1.0, "cm": 1e-2, "mm": 1e-3})
DEGREES: MappingType[AngleUnit, float] = MappingProxyType({"deg": 1.0, "rad": degrees(1.0), "turn": 360.0})
FULL_TURN_DEG = 360.0

_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, coerce_numbers_to_str=True)


@final
class LengthSource(BaseModel):
    """A column that is a length in `unit` once multiplied by `gain` and moved by `offset`."""

    model_config = _STRICT

    column: str
    unit: LengthUnit = "m"
    gain: float = 1.0
    offset: float = 0.0


@final
class AngleSource(BaseModel):
    """A column that is an angle in `unit` once multiplied by `gain` and moved by `offset`.

    Attributes:
        column: its name.
        unit: of the angle. For ticks: `deg`, with the degrees in a tick as `gain`.
        gain: negative where the column grows the other way round.
        offset: in `unit`.
        wraps_at: the value at which the column starts anew, in its own unit; it is unwrapped. A heading is
            unwrapped at a full turn without it.
    """

    model_config = _STRICT

    column: str
    unit: AngleUnit = "deg"
    gain: float = 1.0
    offset: float = 0.0
    wraps_at: float | None = Field(default=None, gt=0.0)


@final
class DutySource(BaseModel):
    """A column that is a duty in percent once multiplied by `gain` and moved by `offset`."""

    model_config = _STRICT

    column: str
    gain: float = 1.0
    offset: float = 0.0


@final
class RobotMapping(BaseModel):
    """The mapping of a table that a robot on two wheels fills. Its left wheel becomes port b, its right one port c.

    Attributes:
        pose_x: measured from outside.
        pose_y: likewise; to the left of x.
        pose_heading: likewise; counter-clockwise.
        left_angle: of the left wheel, positive forward.
        right_angle: of the right wheel, positive forward.
        left_power: commanded on the left motor, positive forward.
        right_power: commanded on the right motor, positive forward.
        supply: the battery's voltage.
        split: the column that tells recordings apart.
    """

    model_config = _STRICT

    table: TableFormat = TableFormat()
    time: Annotated[TimeSource, FLAT]
    pose_x: Annotated[LengthSource, FLAT]
    pose_y: Annotated[LengthSource, FLAT]
    pose_heading: Annotated[AngleSource, FLAT]
    left_angle: Annotated[AngleSource, FLAT]
    right_angle: Annotated[AngleSource, FLAT]
    left_power: Annotated[DutySource | None, FLAT] = None
    right_power: Annotated[DutySource | None, FLAT] = None
    supply: Annotated[SupplySource | None, FLAT] = None
    split: Annotated[SplitColumn | None, FLAT] = None

    @model_validator(mode="before")
    @classmethod
    def _split_in_table(cls, given: Any) -> Any:  # noqa: ANN401  # what a user wrote
        return with_split_of_table(given)

    @model_validator(mode="after")
    def _both_powers(self) -> Self:
        if (self.left_power is None) != (self.right_power is None):
            lacking = "left_power" if self.left_power is None else "right_power"
            raise ValueError(f"names one power alone; write {lacking} too, or neither")
        return self
