"""Motor programs: what to command when, as a file that a person can read, edit and run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self, final

import yaml
from pydantic import BaseModel, ConfigDict, Field, model_validator

from nxt_twin.errors import ProgramError
from nxt_twin.recording.columns import PORTS, DriveMode, Port
from nxt_twin.recording.yaml_file import read_model

_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


@final
class Segment(BaseModel):
    """A stretch of time under one command.

    Attributes:
        duration_s: how long.
        power_pct: duty at its beginning, -100 to 100.
        end_power_pct: duty at its end, where it is a ramp; a ramp moves in whole percents.
        mode: how the bridge drives; `coast` and `brake` go with no power.
    """

    model_config = _STRICT

    duration_s: float = Field(gt=0.0, le=3600.0)
    power_pct: int = Field(default=0, ge=-100, le=100)
    end_power_pct: int | None = Field(default=None, ge=-100, le=100)
    mode: DriveMode = "drive"

    @model_validator(mode="after")
    def _resting_modes_have_no_power(self) -> Self:
        if self.mode in ("coast", "brake") and (self.power_pct or self.end_power_pct):
            raise ValueError(f"power in mode {self.mode}")
        return self


@final
class Run(BaseModel):
    """What becomes one recording: its segments, one after the other, from rest."""

    model_config = _STRICT

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$")
    segments: tuple[Segment, ...] = Field(min_length=1, max_length=100_000)

    @property
    def duration_s(self) -> float:
        """The sum of its segments, s."""
        return sum(segment.duration_s for segment in self.segments)


@final
class MotorProgram(BaseModel):
    """Runs of motors, and what they are for.

    Attributes:
        kind: what the file is; other experiments have other kinds.
        name: what it is called.
        why: one sentence for the person who runs it.
        ports: motors that are commanded alike.
        runs: each becomes a recording.
        rest_s: how long the motors coast between two runs.
        most_turn_deg: how far a motor may turn from where it began, either way, before the run is ended; none: any.
    """

    model_config = _STRICT

    kind: Literal["motor_program"] = "motor_program"
    name: str = Field(min_length=1, max_length=80)
    why: str = ""
    ports: tuple[Port, ...] = ("a",)
    runs: tuple[Run, ...] = Field(min_length=1)
    rest_s: float = Field(default=1.0, ge=0.0)
    most_turn_deg: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _ports_once(self) -> Self:
        if not self.ports or len(set(self.ports)) < len(self.ports):
            raise ValueError(f"ports: name each of {', '.join(PORTS)} once at most, and one at least")
        return self


@final
@dataclass(frozen=True)
class MotorCommand:
    """The command from `start_s` after a run's beginning until the next command."""

    start_s: float
    power_pct: int
    mode: DriveMode


def commands(run: Run) -> Iterator[MotorCommand]:
    """The commands of a run in order; a ramp is one command for each whole percent."""
    start_s = 0.0
    for segment in run.segments:
        end = segment.power_pct if segment.end_power_pct is None else segment.end_power_pct
        count = abs(end - segment.power_pct) + 1
        direction = 1 if end >= segment.power_pct else -1
        for n in range(count):
            yield MotorCommand(
                start_s + n * segment.duration_s / count, segment.power_pct + n * direction, segment.mode
            )
        start_s += segment.duration_s


def read_program(path: Path) -> MotorProgram:
    """Read a motor program.

    Raises:
        ProgramError: it is none; the text names the key.
    """
    return read_model(path, MotorProgram, ProgramError)


def write_program(program: MotorProgram, path: Path) -> None:
    """Write a motor program as YAML, to be read by `read_program`."""
    document = program.model_dump(mode="json", exclude_none=True)
    path.write_text(yaml.safe_dump(document, sort_keys=False, allow_unicode=True), encoding="utf-8")
