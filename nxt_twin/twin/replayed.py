"""A recording played to the twin as if the brick were there."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from typing import Any

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.links.recorded import RecordedBrick, RecordedCommands
from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import (
    SLOTS,
    Port,
    SensorSlot,
    light_column,
    sound_column,
    touch_column,
    ultrasonic_column,
)
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.adopt import Adopter
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.outcome import Sitting
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Sink
from nxt_twin.twin.sensor_twin import PortSensor
from nxt_twin.twin.session import Parts
from nxt_twin.twin.settings import AT_ARRIVAL

_SENSOR_EVERY_S = 0.0
"""A sensor is asked in every poll, and answers when a new sample of it stands in the recording."""


def replay_sitting(
    recording: Recording,
    plants: Mapping[Port, Plant],
    clock: Clock,
    sink: Sink,
    diagnosing: Executor | None = None,
) -> tuple[Sitting, float]:
    """A session with a recorded brick that is ready to run, and how long it lasts, s.

    Args:
        recording: of a brick, with commands and counts.
        plants: the model of each motor that is watched; the recording has each of these.
        clock: what the recorded brick goes by.
        sink: is told of every poll and event.
        diagnosing: where a divergence is diagnosed, so that what is found is taken over; None diagnoses none.

    Raises:
        PlantError: the plants cannot stand side by side.
    """
    brick = RecordedBrick(recording, clock)
    parts = Parts(
        open_brick=lambda: Brick(brick, clock),
        clock=clock,
        twin=BrickTwin(plants, TwinOptions(bridge=plain_bridge)),
        sink=sink,
        plan=Plan(sensors_of(recording), sensor_every_s=_SENSOR_EVERY_S, ultrasonic_every_s=_SENSOR_EVERY_S),
        pace=AT_ARRIVAL,
        driver=RecordedCommands(brick, tuple(plants)),
        adopter=None if diagnosing is None else Adopter(diagnosing),
        lags=recording.lags,
    )
    return Sitting(parts), brick.duration_s


def sensors_of(recording: Recording) -> dict[SensorSlot, PortSensor]:
    """The sensors of a recording, by its columns."""
    names: Mapping[PortSensor, Any] = {
        "touch": touch_column,
        "light": light_column,
        "sound": sound_column,
        "ultrasonic": ultrasonic_column,
    }
    found: dict[SensorSlot, PortSensor] = {}
    for slot in SLOTS:
        for kind, name in names.items():
            if name(slot) in recording.columns:
                found.setdefault(slot, kind)
    return found
