"""Carry a sensor experiment out: go to each place, wait, read, write down."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, final

from firmware_protocol.ultrasonic import NO_ECHO, UltrasonicCommand
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.folder import RowWriter, RunFolder
from nxt_twin.experiment.positioner.by_hand import Ask
from nxt_twin.experiment.positioner.positioner import Positioner, PositionerAxis, within
from nxt_twin.experiment.sweep import Sweep, SweepPart, SweepPoint
from nxt_twin.recording.columns import TIME
from nxt_twin.twin.settings import Pace

_GAP_S: Final = 1.0
"""The gap that the stamps skip between an earlier attempt and its continuation."""


@final
@dataclass(frozen=True)
class SweepProgress:
    """How far an experiment is.

    Attributes:
        done, total: places (or runs), of which those after an early end count as done.
        words: what is being done.
    """

    done: int
    total: int
    words: str


TellProgress = Callable[[SweepProgress], None]


@final
@dataclass(frozen=True)
class Apparatus:
    """The brick, the clock, the positioners and the person of an experiment.

    Attributes:
        brick: the brick, open.
        clock: stamps and waits.
        positioners: one for each axis that is moved.
        ask: a person who prepares things.
        tell: is told how far it is.
        pace: when, between request and reply, the brick acts.
    """

    brick: Brick
    clock: Clock
    positioners: Mapping[PositionerAxis, Positioner]
    ask: Ask
    tell: TellProgress = lambda _: None
    pace: Pace = field(default_factory=Pace)


def run_sweep(sweep: Sweep, folder: RunFolder, around: Apparatus) -> None:
    """Do everything that the folder does not hold yet.

    However it ends, the positioners stand still.

    Raises:
        PositionerError: a place is out of the limits - before anything moves - or cannot be reached.
        ExperimentError: an axis has no positioner.
        BrickError: the brick does not answer.
    """
    _check(sweep, around.positioners)
    read = _set_up(sweep, around)
    done = 0
    try:
        for part in sweep.parts:
            if not folder.finished(part.name):
                _run_part(part, sweep, folder, around, read, done)
            done += len(part.places)
    finally:
        for positioner in around.positioners.values():
            positioner.stop()


def _check(sweep: Sweep, positioners: Mapping[PositionerAxis, Positioner]) -> None:
    for axis in sweep.axes:
        if axis not in positioners:
            raise ExperimentError(f"nothing moves {axis}", where="positioners", mend=f"add one for {axis}")
    for part in sweep.parts:
        for place in part.places:
            for axis, value in zip(sweep.axes, place, strict=True):
                within(positioners[axis].limits, axis, value)


def _run_part(
    part: SweepPart,
    sweep: Sweep,
    folder: RunFolder,
    around: Apparatus,
    read: Callable[[], float],
    before: int,
) -> None:
    columns = (TIME, sweep.column, *sweep.rig_columns)
    rows = [] if part.in_one_go else folder.begun(part.name, columns)
    visited = len(rows) // sweep.samples
    kept = rows[: visited * sweep.samples]
    if part.request:
        around.ask(f"{part.request} [Enter when done] ")
    _switch_other(part, sweep, around)
    clock = around.clock
    zero_s = clock.now_s() - (float(kept[-1][TIME]) + _GAP_S if kept else 0.0)
    readings = [float(row[sweep.column]) for row in kept[-sweep.samples :]]
    with folder.write(part.name, columns, kept) as writer:
        for number, place in enumerate(part.places):
            if part.until_silent and _silent(readings):
                break
            if number < visited:
                continue
            words = ", ".join(f"{axis} {value:g}" for axis, value in zip(sweep.axes, place, strict=True))
            around.tell(SweepProgress(before + number, sweep.places, f"{part.name}: {words}"))
            readings = _read_place(place, sweep, around, read, writer, zero_s)
        writer.finish()


def _read_place(
    place: SweepPoint,
    sweep: Sweep,
    around: Apparatus,
    read: Callable[[], float],
    writer: RowWriter,
    zero_s: float,
) -> list[float]:
    reached = [around.positioners[axis].move_to(value) for axis, value in zip(sweep.axes, place, strict=True)]
    around.brick.device.keep_awake()
    around.clock.sleep(sweep.pace.settle_s)
    readings = []
    for number in range(sweep.samples):
        if number:
            around.clock.sleep(sweep.pace.every_s)
        readings.append(read())
        rig = dict(zip(sweep.rig_columns, reached, strict=True))
        writer.append({TIME: around.clock.now_s() - zero_s, sweep.column: readings[-1], **rig})
    return readings


def _silent(readings: Sequence[float]) -> bool:
    return bool(readings) and all(reading >= NO_ECHO for reading in readings)


def _set_up(sweep: Sweep, around: Apparatus) -> Callable[[], float]:
    """Set the sensor's port up, and give what reads it once."""
    brick, port = around.brick, sweep.slot - 1
    match sweep.sensor:
        case "ultrasonic":
            brick.ultrasonic.set_up(port)
            return lambda: float(brick.ultrasonic.distance_cm(port).value)
        case "touch":
            brick.sensors.set_up_touch(port)
            brick.sensors.read_valid(port)
            return lambda: float(brick.sensors.pressed(port).value)
        case _:
            brick.sensors.set_up_light(port, lamp=sweep.sensor == "light")
            brick.sensors.read_valid(port)
            return lambda: float(brick.sensors.read(port).value.raw)


def _switch_other(part: SweepPart, sweep: Sweep, around: Apparatus) -> None:
    """Let the second ultrasonic sensor ping, or be quiet."""
    if part.other_pings is None or sweep.other_slot is None:
        return
    port = sweep.other_slot - 1
    around.brick.ultrasonic.set_up(port)
    around.clock.sleep(sweep.pace.settle_s)
    command = UltrasonicCommand.CONTINUOUS if part.other_pings else UltrasonicCommand.OFF
    around.brick.ultrasonic.command(port, command)
