"""The columns that a recording may have (docs/formats.md#recordings)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from types import MappingProxyType
from typing import Literal, final

from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import nearest_name, quoted

Port = Literal["a", "b", "c"]
SensorSlot = Literal[1, 2, 3, 4]
Role = Literal["stamp", "command", "reading", "truth"]
DriveMode = Literal["drive", "float", "coast", "brake"]
Regulation = Literal["none", "speed"]

PORTS: tuple[Port, ...] = ("a", "b", "c")
SLOTS: tuple[SensorSlot, ...] = (1, 2, 3, 4)
DRIVE_MODES: tuple[DriveMode, ...] = ("drive", "float", "coast", "brake")
REGULATIONS: tuple[Regulation, ...] = ("none", "speed")
TIME = "time_s"
BATTERY = "battery_v"
POSE_X = "pose_x_m"
POSE_Y = "pose_y_m"
POSE_HEADING = "pose_heading_deg"
MAPPED_COLUMNS = ("input", "output", "mode", "supply_v")


@final
@dataclass(frozen=True)
class Column:
    """What one column holds.

    Attributes:
        unit: its unit, empty for words and bare numbers.
        role: `command` is in force until the row that changes it; `reading` and `truth` may be left empty.
        lowest: the least value that the thing measured or commanded can take.
        highest: the greatest.
        words: for a column of words, the words; it is held as indices into them.
    """

    unit: str
    role: Role
    lowest: float = -inf
    highest: float = inf
    words: tuple[str, ...] = ()


def power_column(port: Port) -> str:
    """The name of the duty commanded on a port."""
    return f"{port}_power_pct"


def mode_column(port: Port) -> str:
    """The name of the drive mode commanded on a port."""
    return f"{port}_mode"


def tacho_column(port: Port) -> str:
    """The name of the encoder's count at a port."""
    return f"{port}_tacho_deg"


def regulation_column(port: Port) -> str:
    """The name of what regulates a port's power."""
    return f"{port}_regulation"


def goal_column(port: Port) -> str:
    """The name of the goal that a position loop on a port is given."""
    return f"{port}_goal_deg"


def ultrasonic_column(slot: SensorSlot) -> str:
    """The name of the ultrasonic distance read at a sensor's slot."""
    return f"s{slot}_ultrasonic_cm"


def light_column(slot: SensorSlot) -> str:
    """The name of the light reading at a sensor's slot."""
    return f"s{slot}_light_raw"


def sound_column(slot: SensorSlot) -> str:
    """The name of the sound reading at a sensor's slot."""
    return f"s{slot}_sound_raw"


def touch_column(slot: SensorSlot) -> str:
    """The name of the touch reading at a sensor's slot."""
    return f"s{slot}_touch"


_MOTOR = {
    power_column: Column("%", "command", lowest=-100.0, highest=100.0),
    mode_column: Column("", "command", words=DRIVE_MODES),
    regulation_column: Column("", "command", words=REGULATIONS),
    goal_column: Column("deg", "command"),
    tacho_column: Column("deg", "reading"),
}
_SENSOR = {
    ultrasonic_column: Column("cm", "reading", lowest=0.0, highest=255.0),
    light_column: Column("", "reading", lowest=0.0, highest=1023.0),
    sound_column: Column("", "reading", lowest=0.0, highest=1023.0),
    touch_column: Column("", "reading", lowest=0.0, highest=1.0),
}

CATALOGUE: Mapping[str, Column] = MappingProxyType(
    {TIME: Column("s", "stamp")}
    | {name(port): column for port in PORTS for name, column in _MOTOR.items()}
    | {BATTERY: Column("V", "reading", lowest=0.0)}
    | {name(slot): column for slot in SLOTS for name, column in _SENSOR.items()}
    | {
        "rig_distance_mm": Column("mm", "truth"),
        "rig_angle_deg": Column("deg", "truth"),
        "rig_force_g": Column("g", "truth"),
        "rig_compression_mm": Column("mm", "truth"),
        "rig_position_mm": Column("mm", "truth"),
        POSE_X: Column("m", "reading"),
        POSE_Y: Column("m", "reading"),
        POSE_HEADING: Column("deg", "reading"),
    }
)


def check_names(names: Sequence[str], path: Path) -> None:
    """Check a table's column names against the catalogue.

    Raises:
        RecordingError: for a column that is unknown or there twice, or if `time_s` is missing.
    """
    for name, count in Counter(names).items():
        if name not in CATALOGUE:
            raise RecordingError(
                f"unknown column {quoted(name)}", where=str(path), mend=_advice(name, names, path)
            )
        if count > 1:
            raise RecordingError("is there twice", where=f"{path}, column {name}", mend="keep one of them")
    if TIME not in names:
        mend = "add the stamp of each row in seconds"
        raise RecordingError(f"has no column {TIME}", where=str(path), mend=mend)


def mapping_advice(path: Path) -> str:
    """How a table whose columns are not a recording's is read."""
    beside = path.with_suffix(".yaml").name
    command = f"nxt-twin map {path.name} --out {beside}"
    return f"run `{command}`, or write `time:`, `input:` and `output: {{column: …}}` in {beside}"


def _advice(name: str, names: Sequence[str], path: Path) -> str:
    if len(names) == 1 and any(mark in name for mark in ";\t|"):
        return f"separate the columns by commas, or {mapping_advice(path)}"
    if name in MAPPED_COLUMNS:
        return "a mapped recording is read through a mapping file"
    return f"nearest known: {nearest_name(name, CATALOGUE)}; {mapping_advice(path)}"
