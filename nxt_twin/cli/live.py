"""`nxt-twin live`: brick and twin side by side."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick
from nxt_twin.cli.output import JsonOption, fail
from nxt_twin.cli.wanted import NOTHING, chosen_url, get_leave, wanted_ports, wanted_sensors
from nxt_twin.cli.watching import View, audience, conclude, get_ready, watch
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import Port
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.programs import load_program
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.adopt import Adopter
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.logbook import columns_of
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Sink
from nxt_twin.twin.sensor_twin import SensorTwin
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import pace_of

_AS_SHIPPED = "1:touch,2:sound,3:light,4:ultrasonic"
_BUILT_IN = "excitation"
_PATIENT = 5


def live(
    url: Annotated[str | None, typer.Argument(help="As for connect; without: the first brick found.")] = None,
    plant: Annotated[str, typer.Option(help="Model of the motors: a name or a YAML file.")] = "nxt_motor",
    ports: Annotated[str, typer.Option(help="Motors to watch.")] = "abc",
    sensors: Annotated[str, typer.Option(help="Such as 1:touch,4:ultrasonic; or none.")] = _AS_SHIPPED,
    program: Annotated[
        str, typer.Option(help="A motor program's file or name; none only watches what others command.")
    ] = _BUILT_IN,
    seconds: Annotated[
        float, typer.Option(min=0.0, help="How long; 0 goes on until Ctrl-C. The program is repeated.")
    ] = 30.0,
    adopt: Annotated[
        bool, typer.Option("--adopt", help="Diagnose a divergence, take over what is found, and go on.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Record the session: .csv or .parquet.")] = None,
    model_out: Annotated[Path | None, typer.Option(help="Write the adopted plant as YAML.")] = None,
    view: Annotated[View, typer.Option(help="Dashboard: a window, in the browser, or none.")] = "none",
    save: Annotated[Path | None, typer.Option(help="Keep the dashboard's data: .rrd.")] = None,
    report: Annotated[
        Path | None,
        typer.Option(help="Folder for HTML reports: of the session, and of what --adopt diagnoses."),
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before motors turn.")] = False,
    json: JsonOption = None,
) -> None:
    """Watch a brick beside its model: what is measured, what was predicted, and when they part.

    The motors run a program of steps, ramps and rests unless another is named, so put the robot on blocks. Ctrl-C
    ends it, and the motors coast. Exit status 0 whatever the verdict, which the last line and the JSON tell; 1 if
    the brick cannot be reached, or not a single poll came about; 2 for wrong use.
    """
    hold(
        url, plant=plant, ports=ports, sensors=sensors, program=program, seconds=seconds, adopt=adopt, out=out,
        model_out=model_out, view=view, save=save, report=report, yes=yes, json=json,
    )  # fmt: skip


def hold(
    url: str | None,
    *,
    plant: str,
    ports: str,
    sensors: str,
    program: str = _BUILT_IN,
    seconds: float,
    adopt: bool,
    out: Path | None,
    model_out: Path | None,
    view: View,
    save: Path | None,
    report: Path | None,
    yes: bool = False,
    json: str | None,
    also: Sequence[Sink] = (),
    enough: Callable[[], bool] = lambda: False,
) -> None:
    """Hold a session as `live` does, with somebody else told of it (`also`), who may say when it is `enough`.

    Raises:
        typer.BadParameter: wrong use.
        typer.Exit: there was no poll.
        NxtTwinError: whatever kept it from being held.
    """
    wanted, slots, clock = wanted_ports(ports), wanted_sensors(sensors), SystemClock()
    driver = _driver(program, wanted)
    found = chosen_url(url, clock)
    if driver is not None:
        get_leave(found, driver.ports, yes=yes)
    plants = dict.fromkeys(wanted, plant_from_config(load_plant_config(plant), "power_pct"))
    get_ready(plants, adopting=adopt)
    recorder = None if out is None else RecordingWriter(out, columns_of(wanted, slots))
    channels = [SensorTwin(slot, kind).column for slot, kind in slots.items()]
    told = audience(
        wanted, channels, title=found, view=view, save=save, report=report is not None, quiet=json == "-", also=also
    )  # fmt: skip
    parts = Parts(
        open_brick=lambda: open_brick(found, clock, OPENERS),
        clock=clock,
        twin=BrickTwin(plants),
        sink=told.sink(),
        plan=Plan(sensors=slots),
        pace=pace_of(found),
        driver=driver,
        recorder=recorder,
        adopter=Adopter(ThreadPoolExecutor(1, "diagnosis", _step_back)) if adopt else None,
        enough=enough,
    )
    session = Session(parts)
    if recorder is not None:
        recorder.keep_lags(session.row_lags)
    watch(session, parts, seconds or None, told)
    conclude(
        session, parts, told, schema="nxt-twin/live/1", title=found, json=json, model_out=model_out, report=report
    )  # fmt: skip
    if not session.polls:
        fail("not a single poll came about, so nothing was recorded: give it more --seconds")
        raise typer.Exit(1)


def _driver(program: str, ports: tuple[Port, ...]) -> ProgramDriver | None:
    if program == NOTHING:
        return None
    loaded = excitation(ports) if program == _BUILT_IN else load_program(program)
    missing = [port for port in loaded.ports if port not in ports]
    if missing:
        raise typer.BadParameter(f"the program drives {', '.join(missing)}, which --ports leaves out")
    return ProgramDriver(loaded)


def _step_back() -> None:
    """Let a diagnosis have what polling leaves of the processor; threads that it starts inherit this."""
    if sys.platform == "linux":  # where a thread has a priority of its own
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _PATIENT)
