"""Paths for a robot to drive, as a file that a person can read and a program can drive."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, Self, final

import yaml
from pydantic import BaseModel, ConfigDict, Field, model_validator

_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


@final
class Leg(BaseModel):
    """A piece of a path; give one of the three.

    Attributes:
        travel_m: straight on, backward where negative.
        turn_deg: on the spot, counter-clockwise.
        rest_s: stand still.
    """

    model_config = _STRICT

    travel_m: float | None = Field(default=None, ge=-100.0, le=100.0)
    turn_deg: float | None = Field(default=None, ge=-36_000.0, le=36_000.0)
    rest_s: float | None = Field(default=None, gt=0.0, le=3600.0)

    @model_validator(mode="after")
    def _one_of_three(self) -> Self:
        if sum(each is not None for each in (self.travel_m, self.turn_deg, self.rest_s)) != 1:
            raise ValueError("give one of travel_m, turn_deg and rest_s")
        return self


@final
class RobotPath(BaseModel):
    """A path, and what it is for.

    Attributes:
        kind: what the file is; other experiments have other kinds.
        name: what it is called.
        why: one sentence for the person who drives it.
        legs: in their order.
    """

    model_config = _STRICT

    kind: Literal["robot_path"] = "robot_path"
    name: str = Field(min_length=1, max_length=80)
    why: str = ""
    legs: tuple[Leg, ...] = Field(min_length=1, max_length=10_000)


def squares_and_lines(
    why: str, *, side_m: float = 1.0, laps: int = 5, straight_m: float = 2.0, rest_s: float = 2.0
) -> RobotPath:
    """Squares both ways round, then a straight way forward and back at two headings.

    Args:
        why: one sentence.
        side_m: of a square.
        laps: each way round.
        straight_m: length of the straight way.
        rest_s: between two legs.
    """
    rest = Leg(rest_s=rest_s)
    corner = (Leg(travel_m=side_m), rest)
    round_left = (*corner, Leg(turn_deg=90.0), rest) * 4 * laps
    round_right = (*corner, Leg(turn_deg=-90.0), rest) * 4 * laps
    line = (Leg(travel_m=straight_m), rest, Leg(travel_m=-straight_m), rest)
    legs = (rest, *round_left, *round_right, *line, Leg(turn_deg=90.0), rest, *line)
    return RobotPath(name="Squares and lines", why=why, legs=legs)


def write_path(driven: RobotPath, path: Path) -> None:
    """Write a robot's path as YAML, in the form of the model `RobotPath`."""
    document = driven.model_dump(mode="json", exclude_none=True)
    path.write_text(yaml.safe_dump(document, sort_keys=False, allow_unicode=True), encoding="utf-8")
