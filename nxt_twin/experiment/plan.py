"""Experiments as files: what is to be done, with what numbers; one `kind` each."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self, final

import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from nxt_twin.errors import ProgramError
from nxt_twin.recording.columns import Port, SensorSlot
from nxt_twin.recording.configs import configs_dir
from nxt_twin.recording.program import Run
from nxt_twin.recording.source import nearest_name, quoted
from nxt_twin.recording.yaml_file import read_part, read_yaml
from nxt_twin.recording.yaml_place import YamlPlace

_STRICT = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
_NAME = r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,40}$"

_MOST_PLACES = 20_000
_PING_S = 0.05

Positive = Annotated[float, Field(gt=0.0)]
Samples = Annotated[int, Field(ge=1, le=1000)]


@final
class Waits(BaseModel):
    """How long to wait.

    Within 50 ms of a move or of its last reading, an ultrasonic sensor may answer with an earlier ping.

    Attributes:
        settle_s: after a move, before the first reading.
        every_s: from one reading to the next; for the ultrasonic sensor at least its own time between pings.
    """

    model_config = _STRICT

    settle_s: float = Field(default=0.2, ge=0.0, le=60.0)
    every_s: float = Field(default=0.06, ge=0.0, le=60.0)


def _after_a_ping(pace: Waits) -> Waits:
    if pace.settle_s < _PING_S or pace.every_s < _PING_S:
        raise ValueError(f"settle_s and every_s of an ultrasonic sensor are {_PING_S:g} s at least")
    return pace


UltrasonicPace = Annotated[Waits, AfterValidator(_after_a_ping)]


@final
class Range(BaseModel):
    """Values of an axis, one after the other, both ends included.

    Attributes:
        first, last: the ends; `last` may be the smaller one.
        step: from one to the next, always positive.
    """

    model_config = _STRICT

    first: float
    last: float
    step: Positive

    @model_validator(mode="after")
    def _not_endless(self) -> Self:
        if abs(self.last - self.first) / self.step > _MOST_PLACES:
            raise ValueError(f"more than {_MOST_PLACES} steps")
        return self

    def values(self) -> tuple[float, ...]:
        """All of them, in order."""
        count = int(abs(self.last - self.first) / self.step + 1e-9) + 1
        sign = 1.0 if self.last >= self.first else -1.0
        return tuple(round(self.first + n * sign * self.step, 9) for n in range(count))


class _BeforeATarget(BaseModel):
    """Section III.C: an ultrasonic sensor before a target that is put at several distances.

    Attributes:
        slot: the sensor's port.
        distance_mm: where the target is put.
        samples: readings at each place.
        pace: how long to wait.
    """

    model_config = _STRICT

    kind: str
    name: str
    why: str = ""
    slot: SensorSlot = 4
    distance_mm: Range
    samples: Samples = 1
    pace: UltrasonicPace = Waits()


@final
class DistanceSweep(_BeforeATarget):
    """The sensor square on to its target, at every distance."""

    kind: Literal["distance_sweep"]


@final
class AngleSweep(_BeforeATarget):
    """The sensor turned away from its target until no echo is left, at each distance.

    Attributes:
        angle_deg: to what the sensor is turned, growing; ended early where no reading is valid.
    """

    kind: Literal["angle_sweep"]
    angle_deg: Range
    samples: Samples = 64


@final
class GradientSweep(BaseModel):
    """Section III.A: a light sensor along a printed gradient, under one or more room lights.

    Attributes:
        slot: the sensor's port.
        position_mm: places along the gradient.
        lightings: names of the room lights; one recording each.
        lamp: whether the sensor's own lamp is on.
        samples: readings at each place.
        pace: how long to wait.
    """

    model_config = _STRICT

    kind: Literal["gradient_sweep"]
    name: str
    why: str = ""
    slot: SensorSlot = 3
    position_mm: Range
    lightings: Annotated[tuple[Annotated[str, Field(pattern=_NAME)], ...], Field(min_length=1)] = ("room",)
    lamp: bool = True
    samples: Samples = 16
    pace: Waits = Waits(settle_s=0.1, every_s=0.0137)


@final
class TouchCycles(BaseModel):
    """Section III.B: a button that is pressed and let go step by step, over and over.

    Attributes:
        slot: the sensor's port.
        axis: whether force or travel is set.
        push: from not pressed to well pressed; back the same way.
        cycles: how often.
        pace: how long to wait.
    """

    model_config = _STRICT

    kind: Literal["touch_cycles"]
    name: str
    why: str = ""
    slot: SensorSlot = 1
    axis: Literal["force_g", "compression_mm"] = "force_g"
    push: Range
    cycles: int = Field(default=8, ge=1, le=1000)
    pace: Waits = Waits(settle_s=0.05, every_s=0.0)

    @model_validator(mode="after")
    def _grows(self) -> Self:
        if self.push.last <= self.push.first:
            raise ValueError("push: begin with the button free and end with it pressed")
        return self


@final
class TwoSensors(BaseModel):
    """Section III.C: which opening of an ultrasonic sensor speaks and which listens, and where they are.

    A strip is slid over the face of the sensor under test, once alone and once with a second sensor pinging.
    Where it covers the emitter, the other's pings are still heard; where it covers the receiver, nothing is.

    Attributes:
        slot: the port of the sensor under test.
        other_slot: the port of the second one, which looks at the same target.
        position_mm: places of the strip's middle along the face, 0 between the openings, positive to the right
            as one looks at the face.
        samples: readings at each place.
        pace: how long to wait.
    """

    model_config = _STRICT

    kind: Literal["two_sensors"]
    name: str
    why: str = ""
    slot: SensorSlot = 4
    other_slot: SensorSlot = 1
    position_mm: Range
    samples: Samples = 16
    pace: UltrasonicPace = Waits()

    @model_validator(mode="after")
    def _two(self) -> Self:
        if self.slot == self.other_slot:
            raise ValueError("other_slot: the two sensors need two ports")
        return self


@final
class Load(BaseModel):
    """What hangs on the motor during a set of runs.

    Attributes:
        name: of the set, which its recordings begin with.
        added_inertia_kg_m2: of a disc or bar on the hub, from its mass and size; 0 for the bare motor.
        added_inertia_std_kg_m2: how well that is known.
    """

    model_config = _STRICT

    name: str = Field(pattern=_NAME)
    added_inertia_kg_m2: float = Field(default=0.0, ge=0.0, le=1.0)
    added_inertia_std_kg_m2: float = Field(default=0.0, ge=0.0, le=1.0)


@final
class Anchor(BaseModel):
    """A value that comes from another instrument: encoder and voltage alone give only ratios."""

    model_config = _STRICT

    value: Positive
    std: Positive


@final
class MotorIdentification(BaseModel):
    """Section II: steps and coast-downs of a motor, bare and with a known disc.

    Attributes:
        port: the motor's port.
        plant: the plant that the fit begins with; its resistance is the anchor where no disc is.
        resistance_ohm: the winding's resistance, measured with a meter.
        loads: what hangs on the motor; the runs are done once with each.
        runs: what is commanded; each becomes a recording for each load.
        poll_s: time between polls.
        rest_s: how long the motor has to have stood before each run; the battery is read then.
        most_turn_deg: how far it may turn from where it began; none: any.
    """

    model_config = _STRICT

    kind: Literal["motor_identification"]
    name: str
    why: str = ""
    port: Port = "a"
    plant: str = "nxt_motor"
    resistance_ohm: Anchor = Anchor(value=7.6, std=0.38)
    loads: Annotated[tuple[Load, ...], Field(min_length=1, max_length=2)] = (Load(name="bare"),)
    runs: Annotated[tuple[Run, ...], Field(min_length=2)]
    poll_s: float = Field(default=0.01, gt=0.0, le=1.0)
    rest_s: float = Field(default=1.0, ge=0.0, le=60.0)
    most_turn_deg: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _loads_differ(self) -> Self:
        if len({load.name for load in self.loads}) < len(self.loads):
            raise ValueError("loads: two have the same name")
        if len(self.loads) == 2 and (self.loads[0].added_inertia_kg_m2, self.loads[1].added_inertia_kg_m2)[0]:
            raise ValueError("loads: begin with the bare motor")
        if len(self.loads) == 2 and not self.loads[1].added_inertia_kg_m2:
            raise ValueError("loads: the second has no added inertia")
        return self


SensorExperiment = DistanceSweep | AngleSweep | GradientSweep | TouchCycles | TwoSensors
Experiment = SensorExperiment | MotorIdentification

_KINDS: dict[str, type[Experiment]] = {
    "distance_sweep": DistanceSweep,
    "angle_sweep": AngleSweep,
    "gradient_sweep": GradientSweep,
    "touch_cycles": TouchCycles,
    "two_sensors": TwoSensors,
    "motor_identification": MotorIdentification,
}


def own_experiments() -> list[str]:
    """The names of those that come along, sorted."""
    return [file.stem for file in sorted(_own_folder().glob("*.yaml"))]


def _own_folder() -> Path:
    return configs_dir() / "experiments"


def read_experiment(name_or_path: str | Path) -> Experiment:
    """Read an experiment: a file, or the name of one of the tool's own such as `distance_sweep`.

    Raises:
        ProgramError: there is none, or it holds a key or value that has no meaning.
    """
    path = Path(name_or_path)
    if path.suffix.lower() not in (".yaml", ".yml"):
        path = _own_folder() / f"{name_or_path}.yaml"
        known = own_experiments()
        if str(name_or_path) not in known:
            mend = f"nearest known: {nearest_name(str(name_or_path), known)}; or name a .yaml file"
            raise ProgramError(f"there is no experiment named {quoted(str(name_or_path))}", mend=mend)
    document = read_yaml(path, ProgramError)
    kind = document.get("kind")
    if not isinstance(kind, str) or kind not in _KINDS:
        what = f"{quoted(kind)} is no kind of experiment" if kind else "has no kind"
        raise ProgramError(what, where=f"{path}, key kind", mend=f"one of {', '.join(_KINDS)}")
    return read_part(document, _KINDS[kind], ProgramError, where=YamlPlace(path))


def dump_experiment(experiment: Experiment) -> str:
    """The experiment as YAML with every key, as `read_experiment` reads it."""
    document = experiment.model_dump(mode="json", exclude_none=True)
    return yaml.safe_dump(document, sort_keys=False, allow_unicode=True)
