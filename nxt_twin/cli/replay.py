"""`nxt-twin replay`: a recording beside a model, as if the brick were there."""

from __future__ import annotations

import json as json_format
import math
import sys
from collections.abc import Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal, final

import typer
import yaml

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import PacedClock, SystemClock
from nxt_twin.brick.links.recorded import RecordedBrick, RecordedCommands
from nxt_twin.cli.output import JsonOption, emit_json, progress
from nxt_twin.cli.wanted import wanted_ports
from nxt_twin.diagnose.to_json import to_json
from nxt_twin.errors import RecordingError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import (
    SLOTS,
    Port,
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
from nxt_twin.twin.records import Event, Sink, Tick
from nxt_twin.twin.sensor_twin import SensorKind, SensorTwin
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import Pace
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.twin.verdict import verdict

View = Literal["spawn", "web", "none"]

_DEFAULT_PLANT = "nxt_motor"
_SENSOR_EVERY_S = 0.0
"""A sensor is asked in every poll, and answers when a new sample of it stands in the recording."""
_AT_ARRIVAL = Pace(share=1.0, share_std=0.0)


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
    clock = PacedClock(SystemClock(), speed or math.inf)
    brick = RecordedBrick(played, clock)
    watched = brick.ports if ports is None else tuple(p for p in wanted_ports(ports) if p in brick.ports)
    if not watched:
        raise RecordingError("holds none of these motors", where=str(recording), mend="see --ports")
    slots = sensors_of(played)
    memory = Memory()
    sinks: list[Sink] = [memory] if json == "-" else [memory, _Teller()]
    channels = [SensorTwin(slot, kind).column for slot, kind in slots.items()]
    sinks += _dashboard(view, save, watched, channels, title=recording.name)
    executor: Executor = ThreadPoolExecutor(1, "diagnosis") if speed > 0.0 else AtOnce()
    plant = plant_from_config(load_plant_config(model or played.plant or _DEFAULT_PLANT), "power_pct")
    parts = Parts(
        open_brick=lambda: Brick(brick, clock),
        clock=clock,
        twin=BrickTwin(dict.fromkeys(watched, plant), TwinOptions(bridge=plain_bridge)),
        sink=Several(sinks),
        plan=Plan(sensors=slots, sensor_every_s=_SENSOR_EVERY_S, ultrasonic_every_s=_SENSOR_EVERY_S),
        pace=_AT_ARRIVAL,
        driver=RecordedCommands(brick, watched),
        adopter=Adopter(executor) if adopt else None,
    )
    session = _play(parts, brick.duration_s)
    if model_out is not None:
        _write_models(parts.twin, model_out)
    _conclude(session, memory, parts.adopter, json)


def _play(parts: Parts, seconds: float) -> Session:
    """Play it to its end, or until interrupted, which is an ordinary end."""
    session = Session(parts)
    try:
        with progress("replay"), suppress(KeyboardInterrupt):
            session.run(seconds)
    finally:
        parts.sink.close()
        if parts.adopter is not None:
            parts.adopter.close()
    return session


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


def _write_models(twin: BrickTwin, model_out: Path) -> None:
    for port, plant in twin.plants.items():
        path = model_out.with_stem(f"{model_out.stem}-{port}") if len(twin.plants) > 1 else model_out
        path.write_text(yaml.safe_dump(plant.to_config(), sort_keys=False), encoding="utf-8")


def _conclude(session: Session, memory: Memory, adopter: Adopter | None, json: str | None) -> None:
    said = verdict(memory.events, [port for port, each in session.monitors.items() if each.diverging])
    if json:
        diagnoses = [] if adopter is None else adopter.diagnoses
        answer = {
            "schema": "nxt-twin/replay/1",
            "verdict": said.outcome,
            "sentence": said.sentence,
            "polls": session.polls,
            "events": [asdict(event) for event in memory.events],
            "diagnoses": [
                {"port": port, **json_format.loads(to_json(diagnosis))} for port, diagnosis in diagnoses
            ],
        }
        emit_json(json, json_format.dumps(answer, ensure_ascii=False))
    if json != "-":
        print(said.sentence)


def _dashboard(
    view: View, save: Path | None, ports: tuple[Port, ...], channels: list[str], *, title: str
) -> list[Sink]:
    if view == "none" and save is None:
        return []
    from nxt_twin.view.dashboard import open_dashboard

    dashboard = open_dashboard(
        view=view, save=save, ports=ports, channels=channels, title=title, lossless=True
    )
    if dashboard.url:
        print(f"dashboard: {dashboard.url}", file=sys.stderr, flush=True)
    return [dashboard]


@final
class _Teller:
    """Says events on the terminal."""

    def tick(self, tick: Tick) -> None:
        """Nothing: the dashboard shows polls."""

    def event(self, event: Event) -> None:
        """One line."""
        print(f"{event.time_s:8.1f} s  {event.words}", flush=True)

    def close(self) -> None:
        """Nothing to finish."""
