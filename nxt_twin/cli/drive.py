"""`nxt-twin drive`: run a motor program on a brick, safely."""

from __future__ import annotations

import json as json_format
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock, SystemClock
from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, progress
from nxt_twin.cli.record import RecordedRun, Teller, opened, write_down
from nxt_twin.cli.wanted import chosen_url, get_leave, tidy_end, wanted_ports
from nxt_twin.recording.program import MotorProgram, Run
from nxt_twin.recording.programs import load_program, own_programs
from nxt_twin.recording.stream import check_free
from nxt_twin.twin.driver import ProgramDriver
from nxt_twin.twin.logbook import Logbook
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.settings import Pace, pace_of


def drive(
    program: Annotated[
        str | None, typer.Argument(help="A motor program: a name or a YAML file; without: list the names.")
    ] = None,
    url: Annotated[str | None, typer.Argument(help="As for connect; without: the first brick found.")] = None,
    ports: Annotated[str | None, typer.Option(help="Motors to drive, instead of the program's own.")] = None,
    record: Annotated[
        Path | None,
        typer.Option(
            help="Record it: .parquet or .csv; several runs make several files, named after the runs."
        ),
    ] = None,
    period: Annotated[float, typer.Option(min=0.0, help="Time from poll to poll, s.")] = 0.01,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before motors turn.")] = False,
    json: JsonOption = None,
) -> None:
    """Run a motor program once. The motors coast at its end, after each run, on Ctrl-C and on any error.

    A motor that turns further than the program allows coasts until the next run. On a real brick you are asked before
    motors turn. Ctrl-C gives exit status 1, since the program did not end.
    """
    if program is None:
        _list(json)
        return
    wanted = load_program(program)
    if ports is not None:
        wanted = wanted.model_copy(update={"ports": wanted_ports(ports)})
    files = {run.name: None if record is None else recording_path(record, run, wanted) for run in wanted.runs}
    for file in files.values():
        if file is not None:
            check_free(file)
    clock = SystemClock()
    found = chosen_url(url, clock)
    get_leave(found, wanted.ports, yes=yes)
    if found.startswith("mock:"):
        tell_of_compiling()
    done: list[RecordedRun] = []
    with tidy_end(), opened(found, clock) as brick:
        for run in wanted.runs:
            alone = wanted.model_copy(update={"runs": (run,)})
            plan = Plan(period_s=period)
            done.append(_run(alone, brick, clock, plan, pace_of(found), files[run.name]))
    if json:
        answer = {"program": wanted.name, "ports": wanted.ports, "runs": done}
        emit_json(json, json_format.dumps({"schema": "nxt-twin/drive/1", **answer}))
    if json != "-":
        for run, result in zip(wanted.runs, done, strict=True):
            print(f"{run.name}: {result['seconds']:.1f} s  {result['file'] or ''}".rstrip())


def recording_path(record: Path, run: Run, program: MotorProgram) -> Path:
    """Where a run's recording goes."""
    return record if len(program.runs) == 1 else record.with_stem(f"{record.stem}-{run.name}")


def _run(
    alone: MotorProgram, brick: Brick, clock: Clock, plan: Plan, pace: Pace, file: Path | None
) -> RecordedRun:
    driver = ProgramDriver(alone)
    if file is not None:
        return write_down(
            lambda: nullcontext(brick),
            clock,
            file,
            alone.ports,
            plan,
            pace=pace,
            driver=driver,
            seconds=driver.duration_s,
            may_end=False,
        )
    with progress(f"{alone.name}: {alone.runs[0].name}") as tell:
        teller = Teller(tell)
        Logbook(brick, clock, alone.ports, plan, driver=driver).keep(driver.duration_s, teller)
    return RecordedRun(file=None, rows=teller.last.rows, seconds=round(teller.last.elapsed_s, 3))


def _list(json: str | None) -> None:
    programs = {name: load_program(name) for name in own_programs()}
    if json:
        told = [
            {"name": name, "why": each.why, "seconds": ProgramDriver(each).duration_s, "ports": each.ports}
            for name, each in programs.items()
        ]
        emit_json(
            json, json_format.dumps({"schema": "nxt-twin/programs/1", "programs": told}, ensure_ascii=False)
        )
    if json != "-":
        for name, each in programs.items():
            print(f"{name:20} {ProgramDriver(each).duration_s:4.0f} s  {each.why}")
