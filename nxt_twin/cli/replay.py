"""`nxt-twin replay`: a recording beside a model, as if the brick were there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Annotated, Any

import typer

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import PacedClock, SystemClock
from nxt_twin.brick.links.recorded import RecordedBrick, RecordedCommands
from nxt_twin.cli.output import JsonOption, progress
from nxt_twin.cli.wanted import wanted_ports
from nxt_twin.cli.watching import View, audience, conclude, get_ready, watch
from nxt_twin.errors import RecordingError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import (
    SLOTS,
    Slot,
    light_column,
    sound_column,
    touch_column,
    ultrasonic_column,
)
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import BrickTwin, TwinOptions
from nxt_twin.twin.bridge import plain_bridge
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.sensor_twin import SensorKind, SensorTwin
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import AT_ARRIVAL

_DEFAULT_PLANT = "nxt_motor"
_SENSOR_EVERY_S = 0.0
"""A sensor is asked in every poll, and answers when a new sample of it stands in the recording."""


def replay(
    recording: Annotated[Path, typer.Argument(help="A brick's recording: .csv or .parquet.")],
    model: Annotated[
        str | None,
        typer.Option(help="Model of the motors: a name or a YAML file; else the sidecar's, else nxt_motor."),
    ] = None,
    ports: Annotated[
        str | None, typer.Option(help="Motors to watch; without: all that were recorded.")
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.0, help="How many times as fast as it was; 0 as fast as can be.")
    ] = 1.0,
    adopt: Annotated[
        bool, typer.Option("--adopt", help="Diagnose a divergence, take over what is found, and go on.")
    ] = False,
    view: Annotated[View, typer.Option(help="Dashboard: a window, in the browser, or none.")] = "none",
    save: Annotated[Path | None, typer.Option(help="Keep the dashboard's data: .rrd.")] = None,
    model_out: Annotated[
        Path | None, typer.Option(help="Write the adopted plant of each motor as YAML.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Play a recording to the live twin as if the brick were there: the same filters, the same monitor.

    Exit status 0 whatever the verdict, as with live.
    """
    played = read_recording(recording)
    plant = plant_from_config(load_plant_config(model or played.plant or _DEFAULT_PLANT), "power_pct")
    get_ready({"a": plant}, adopting=adopt)
    clock = PacedClock(SystemClock(), speed or math.inf)
    brick = RecordedBrick(played, clock)
    watched = brick.ports if ports is None else tuple(p for p in wanted_ports(ports) if p in brick.ports)
    if not watched:
        raise RecordingError("holds none of these motors", where=str(recording), mend="see --ports")
    slots = sensors_of(played)
    channels = [SensorTwin(slot, kind).column for slot, kind in slots.items()]
    told = audience(
        watched, channels, title=recording.name, view=view, save=save, quiet=json == "-", lossless=True
    )
    executor: Executor = ThreadPoolExecutor(1, "diagnosis") if speed > 0.0 else AtOnce()
    parts = Parts(
        open_brick=lambda: Brick(brick, clock),
        clock=clock,
        twin=BrickTwin(dict.fromkeys(watched, plant), TwinOptions(bridge=plain_bridge)),
        sink=told.sink(),
        plan=Plan(sensors=slots, sensor_every_s=_SENSOR_EVERY_S, ultrasonic_every_s=_SENSOR_EVERY_S),
        pace=AT_ARRIVAL,
        driver=RecordedCommands(brick, watched),
        adopter=Adopter(executor) if adopt else None,
        lags=played.lags,
    )
    session = Session(parts)
    with progress("replay"):
        watch(session, parts, brick.duration_s, told)
    conclude(
        session, parts, told, schema="nxt-twin/replay/1", title=recording.name, json=json, model_out=model_out
    )


def sensors_of(recording: Recording) -> dict[Slot, SensorKind]:
    """What was plugged in, by the recording's columns."""
    names: Mapping[SensorKind, Any] = {
        "touch": touch_column,
        "light": light_column,
        "sound": sound_column,
        "ultrasonic": ultrasonic_column,
    }
    found: dict[Slot, SensorKind] = {}
    for slot in SLOTS:
        for kind, name in names.items():
            if name(slot) in recording.columns:
                found.setdefault(slot, kind)
    return found
