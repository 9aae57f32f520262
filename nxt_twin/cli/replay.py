"""`nxt-twin replay`: a recording beside a model, as if the brick were there."""

from __future__ import annotations

import math
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.brick.clock import PacedClock, SystemClock
from nxt_twin.brick.links.recorded import RecordedBrick
from nxt_twin.cli.lingering import linger
from nxt_twin.cli.output import JsonOption, progress
from nxt_twin.cli.wanted import wanted_ports
from nxt_twin.cli.watching import Showing, View, audience, conclude, get_ready, watch
from nxt_twin.errors import RecordingError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.files import read_recording
from nxt_twin.twin.adopt import AtOnce
from nxt_twin.twin.replayed import replay_sitting, sensors_of
from nxt_twin.twin.sensor_twin import SensorTwin

_SCHEMA = "nxt-twin/replay/1"
_DEFAULT_PLANT = "nxt_motor"


def replay(
    recording: Annotated[Path, typer.Argument(help="A brick's recording: .csv or .parquet.")],
    model: Annotated[
        str | None,
        typer.Option(
            help="Model of the motors: a name or a YAML file; without: the sidecar's, or nxt_motor."
        ),
    ] = None,
    ports: Annotated[
        str | None, typer.Option(help="Ports of the motors to watch; without: every recorded motor.")
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.0, help="Speed as a multiple of real time; 0: as fast as possible.")
    ] = 1.0,
    adopt: Annotated[
        bool, typer.Option("--adopt", help="Diagnose a divergence and adopt the improved model.")
    ] = False,
    view: Annotated[View, typer.Option(help="Dashboard: a window, in the browser, or none.")] = "none",
    save: Annotated[Path | None, typer.Option(help="Keep the dashboard's data: .rrd.")] = None,
    model_out: Annotated[
        Path | None, typer.Option(help="Write the adopted plant of each motor as YAML.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Play a recording to the live twin, with the filters and the monitor of a live session.

    Exit status 0 after any verdict, as with live.
    """
    played = read_recording(recording)
    plant = plant_from_config(load_plant_config(model or played.plant or _DEFAULT_PLANT), "power_pct")
    get_ready({"a": plant}, adopting=adopt)
    clock = PacedClock(SystemClock(), speed or math.inf)
    recorded = RecordedBrick(played, clock).ports
    watched = recorded if ports is None else tuple(p for p in wanted_ports(ports) if p in recorded)
    if not watched:
        raise RecordingError(
            "holds none of these motors", where=str(recording), mend="name recorded motors with --ports"
        )
    showing = Showing(
        title=recording.name,
        schema=_SCHEMA,
        view=view,
        save=save,
        model_out=model_out,
        json=json,
        lossless=True,
    )
    channels = [SensorTwin(slot, kind).column for slot, kind in sensors_of(played).items()]
    told = audience(watched, channels, showing)
    beside: Executor = ThreadPoolExecutor(1, "diagnosis") if speed > 0.0 else AtOnce()
    sitting, duration_s = replay_sitting(
        played, dict.fromkeys(watched, plant), clock, told.sink(), beside if adopt else None
    )
    with progress("replay"):
        ended = watch(sitting, duration_s, told)
    conclude(sitting.outcome(), told, showing)
    linger(told.dashboards, until_interrupted=ended)
