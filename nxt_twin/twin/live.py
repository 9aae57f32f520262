"""A session with a brick, wired from options: the twin, what drives the motors, what records, who diagnoses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import Port, SensorSlot
from nxt_twin.recording.program import MotorProgram
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.adopt import Adopter
from nxt_twin.twin.beside import diagnosing
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import Detour, Driver, ProgramDriver
from nxt_twin.twin.logbook import columns_to_fill
from nxt_twin.twin.outcome import Sitting
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Sink
from nxt_twin.twin.sensor_twin import PortSensor, SensorTwin
from nxt_twin.twin.session import Parts
from nxt_twin.twin.settings import Pace


@final
@dataclass(frozen=True)
class LiveOptions:
    """The choices of a session with a brick.

    Attributes:
        plants: the model of each motor that is watched.
        sensors: what is plugged in, by slot.
        program: what the motors are commanded, again and again; None only watches what others command.
        driver: commands the motors in the program's place.
        adopt: whether a divergence is diagnosed, and what is found is taken over.
        experiment: whether the motors may run what a diagnosis asks for, in between.
        out: where the session is recorded, .csv or .parquet; None records nothing.
        pace: when, between request and reply, the brick acts.
        enough: says when the session may end before its time.
    """

    plants: Mapping[Port, Plant]
    sensors: Mapping[SensorSlot, PortSensor] = field(default_factory=dict)
    program: MotorProgram | None = None
    driver: Driver | None = None
    adopt: bool = False
    experiment: bool = False
    out: Path | None = None
    pace: Pace = field(default_factory=Pace)
    enough: Callable[[], bool] = lambda: False

    @property
    def channels(self) -> tuple[str, ...]:
        """The sensors' columns."""
        return tuple(SensorTwin(slot, kind).column for slot, kind in self.sensors.items())


def live_sitting(options: LiveOptions, open_brick: Callable[[], Brick], clock: Clock, sink: Sink) -> Sitting:
    """A session that is ready to run.

    Args:
        options: what it does.
        open_brick: opens the link, again after it was lost.
        clock: of all stamps.
        sink: is told of every poll and event.

    Raises:
        PlantError: the plants cannot stand side by side.
        RecordingError: the recording cannot be begun.
        OSError: the recording's sidecar cannot be written.
    """
    recorder = None
    if options.out is not None:
        recorder = RecordingWriter(options.out, columns_to_fill(tuple(options.plants), options.sensors))
    usual = options.driver
    if usual is None and options.program is not None:
        usual = ProgramDriver(options.program)
    detour = None if usual is None else Detour(usual)
    experiment = detour.run if detour is not None and options.experiment else None
    parts = Parts(
        open_brick=open_brick,
        clock=clock,
        twin=BrickTwin(options.plants),
        sink=sink,
        plan=Plan(sensors=options.sensors),
        pace=options.pace,
        driver=detour,
        recorder=recorder,
        adopter=Adopter(diagnosing(), experimenting=experiment is not None) if options.adopt else None,
        experiment=experiment,
        enough=options.enough,
    )
    sitting = Sitting(parts)
    if recorder is not None:
        recorder.keep_lags(sitting.session.row_lags)
    return sitting
