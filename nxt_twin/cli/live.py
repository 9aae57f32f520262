"""`nxt-twin live`: brick and twin side by side."""

from __future__ import annotations

import json as json_format
import os
import sys
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

import typer
import yaml

from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.discovery import default_ways, search
from nxt_twin.brick.errors import LinkRefusedError, LinkUrlError, Refusal
from nxt_twin.brick.open import open_brick
from nxt_twin.cli.openers import OPENERS
from nxt_twin.cli.output import JsonOption, emit_json, fail
from nxt_twin.diagnose.to_json import to_json
from nxt_twin.errors import ProgramError
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.columns import (
    BATTERY,
    PORTS,
    TIME,
    Port,
    Slot,
    mode_column,
    power_column,
    tacho_column,
)
from nxt_twin.recording.configs import configs_dir, load_plant_config
from nxt_twin.recording.program import MotorProgram, read_program
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.adopt import Adopter
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import ProgramDriver, excitation
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.records import Event, Sink, Tick
from nxt_twin.twin.sensor_twin import SensorKind, SensorTwin
from nxt_twin.twin.session import Parts, Session
from nxt_twin.twin.settings import PACES, Pace
from nxt_twin.twin.sinks import Memory, Several
from nxt_twin.twin.verdict import Verdict, verdict

if TYPE_CHECKING:
    from nxt_twin.view.dashboard import Dashboard
    from nxt_twin.view.live_report import Keeper

View = Literal["spawn", "web", "none"]

_SAFE = ("mock", "tcp")
_AS_SHIPPED = "1:touch,2:sound,3:light,4:ultrasonic"
_KINDS = ("touch", "sound", "light", "ultrasonic")
_WATCH_ONLY = "none"
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
    the brick cannot be reached; 2 for wrong use.
    """
    wanted = _ports(ports)
    slots = _slots(sensors)
    found = _find() if url is None else url
    driver = _driver(program, wanted)
    if driver is not None:
        _ask(found, driver, yes=yes)
    twin = _twin(plant, wanted)
    columns = [SensorTwin(slot, kind).column for slot, kind in slots.items()]
    recorder = None if out is None else RecordingWriter(out, _columns(wanted, columns))
    memory = Memory()
    dashboards = _dashboard(view, save, wanted, columns, title=found)
    sinks: list[Sink] = [memory, *dashboards, *([] if json == "-" else [_Printer()])]
    keeper = _keeper(report, sinks)
    clock = SystemClock()
    parts = Parts(
        open_brick=lambda: open_brick(found, clock, OPENERS),
        clock=clock,
        twin=twin,
        sink=Several(sinks),
        plan=Plan(sensors=slots),
        pace=PACES.get(found.partition(":")[0], Pace()),
        driver=driver,
        recorder=recorder,
        adopter=Adopter(ThreadPoolExecutor(1, "diagnosis", _step_back)) if adopt else None,
    )
    session = _run(parts, seconds, dashboards)
    _conclude(
        session, memory, parts, json=json, report=report, model_out=model_out, keeper=keeper, title=found
    )


def _twin(plant: str, ports: tuple[Port, ...]) -> BrickTwin:
    model = plant_from_config(load_plant_config(plant), "power_pct")
    twin = BrickTwin(dict.fromkeys(ports, model))
    twin.move(1e-3)  # brings the compiled plant in before the clock counts
    return twin


def _step_back() -> None:
    """Let a diagnosis have what polling leaves of the processor; threads that it starts inherit this."""
    if sys.platform == "linux":  # where a thread has a priority of its own
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _PATIENT)


def _run(parts: Parts, seconds: float, dashboards: Sequence[Dashboard]) -> Session:
    """Run the session to its end or to Ctrl-C, which is one of its ordinary ends."""
    session = Session(parts)
    try:
        with suppress(KeyboardInterrupt):
            session.run(seconds or None)
    except LinkUrlError as error:
        raise typer.BadParameter(str(error), param_hint="URL") from error
    finally:
        parts.sink.close()
        if parts.recorder is not None:
            parts.recorder.close()
        if parts.adopter is not None:
            parts.adopter.close()
        for trouble in (trouble for dashboard in dashboards for trouble in dashboard.troubles):
            fail(trouble)
    return session


def _conclude(
    session: Session,
    memory: Memory,
    parts: Parts,
    *,
    json: str | None,
    report: Path | None,
    model_out: Path | None,
    keeper: Keeper | None,
    title: str,
) -> None:
    diverging = [port for port, monitor in session.monitors.items() if monitor.diverging]
    said = verdict(memory.events, diverging)
    diagnoses = parts.adopter.diagnoses if parts.adopter is not None else []
    pages = []
    if report is not None and keeper is not None:
        from nxt_twin.view.live_report import write_live_report
        from nxt_twin.view.report import write_report

        pages.append(str(write_live_report(report, keeper, title=title, sentence=said.sentence)))
        for number, (port, diagnosis) in enumerate(diagnoses, start=1):
            named = replace(diagnosis, name=f"live-{port}-{number}")
            pages.append(str(write_report(named, report)))
    if model_out is not None:
        for port, plant in parts.twin.plants.items():
            many = len(parts.twin.ports) > 1
            path = model_out.with_stem(f"{model_out.stem}-{port}") if many else model_out
            path.write_text(yaml.safe_dump(plant.to_config(), sort_keys=False), encoding="utf-8")
    if json:
        emit_json(json, json_format.dumps(_document(session, memory, said, diagnoses, pages)))
    if json != "-":
        print(said.sentence)
        for page in pages:
            print(f"  report: {page}")


def _document(
    session: Session, memory: Memory, said: Verdict, diagnoses: Sequence[Any], pages: list[str]
) -> dict[str, Any]:
    return {
        "schema": "nxt-twin/live/1",
        "verdict": said.outcome,
        "sentence": said.sentence,
        "polls": session.polls,
        "motors": {
            port: {"diverging": monitor.diverging, "trouble": monitor.trouble}
            for port, monitor in session.monitors.items()
        },
        "events": [asdict(event) for event in memory.events],
        "diagnoses": [
            {"port": port, **json_format.loads(to_json(diagnosis))} for port, diagnosis in diagnoses
        ],
        "reports": pages,
    }


class _Printer:
    """Says events on the terminal."""

    def tick(self, tick: Tick) -> None:
        """Nothing: the dashboard shows polls."""

    def event(self, event: Event) -> None:
        """One line."""
        print(f"{event.time_s:8.1f} s  {event.words}", flush=True)

    def close(self) -> None:
        """Nothing to finish."""


def _dashboard(
    view: View, save: Path | None, ports: tuple[Port, ...], channels: list[str], *, title: str
) -> list[Dashboard]:
    if view == "none" and save is None:
        return []
    from nxt_twin.view.dashboard import open_dashboard

    dashboard = open_dashboard(view=view, save=save, ports=ports, channels=channels, title=title)
    if dashboard.url:
        print(f"dashboard: {dashboard.url}", file=sys.stderr, flush=True)
    return [dashboard]


def _keeper(report: Path | None, sinks: list[Sink]) -> Keeper | None:
    """Put what the session's report is made of among the sinks; None where no report is wanted."""
    if report is None:
        return None
    from nxt_twin.view.live_report import Keeper

    keeper = Keeper()
    sinks.append(keeper)
    return keeper


def _columns(ports: tuple[Port, ...], sensors: list[str]) -> list[str]:
    motors = [name(port) for port in ports for name in (power_column, mode_column, tacho_column)]
    return [TIME, *motors, BATTERY, *sensors]


def _ports(text: str) -> tuple[Port, ...]:
    wanted = list(dict.fromkeys(text.lower().replace(",", "")))
    if not wanted or not set(wanted) <= set(PORTS):
        raise typer.BadParameter(f"'{text}' is not out of {''.join(PORTS)}", param_hint="--ports")
    return cast("tuple[Port, ...]", tuple(wanted))


def _slots(text: str) -> dict[Slot, SensorKind]:
    if text == _WATCH_ONLY or not text:
        return {}
    slots: dict[Slot, SensorKind] = {}
    for part in text.split(","):
        slot, _, kind = part.strip().partition(":")
        if slot not in ("1", "2", "3", "4") or kind not in _KINDS:
            raise typer.BadParameter(
                f"'{part}' is not SLOT:KIND, such as 1:touch; kinds are {', '.join(_KINDS)}",
                param_hint="--sensors",
            )
        slots[cast("Slot", int(slot))] = cast("SensorKind", kind)
    return slots


def _driver(program: str, ports: tuple[Port, ...]) -> ProgramDriver | None:
    if program == _WATCH_ONLY:
        return None
    return ProgramDriver(_program(program, ports))


def _program(name: str, ports: tuple[Port, ...]) -> MotorProgram:
    if name == _BUILT_IN:
        return excitation(ports)
    path = Path(name)
    if path.suffix not in (".yaml", ".yml"):
        path = configs_dir() / "programs" / f"{name}.yaml"
        if not path.exists():
            mend = f"use {_BUILT_IN}, {_WATCH_ONLY}, or name a .yaml file"
            raise ProgramError("there is no such motor program", where=repr(name), mend=mend)
    program = read_program(path)
    missing = [port for port in program.ports if port not in ports]
    if missing:
        raise typer.BadParameter(f"the program drives {', '.join(missing)}, which --ports leaves out")
    return program


def _find() -> str:
    for report in search(SystemClock(), default_ways()):
        for brick in report.bricks:
            return brick.url
    raise LinkRefusedError(
        "no brick was found", cause=Refusal.NOT_FOUND, mend="switch it on, or try mock: for one of software"
    )


def _ask(url: str, driver: ProgramDriver, *, yes: bool) -> None:
    if yes or url.partition(":")[0] in _SAFE:
        return
    motors = ", ".join(port.upper() for port in driver.ports)
    if not sys.stdin.isatty():
        raise typer.BadParameter(f"motors {motors} will turn: say --yes", param_hint="--yes")
    if not typer.confirm(f"Motors {motors} of {url} will turn both ways. Is the robot on blocks?"):
        fail("nothing was done")
        raise typer.Exit(1)
