"""`nxt-twin record`: write down what a brick's motors and sensors do."""

from __future__ import annotations

import json as json_format
import math
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Annotated, TypedDict, final

import typer

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock, PacedClock, SystemClock
from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.brick.open import open_brick
from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, fail, progress
from nxt_twin.cli.wanted import NOTHING, chosen_url, get_leave, tidy_end, wanted_ports, wanted_sensors
from nxt_twin.recording.columns import Port
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.programs import load_program
from nxt_twin.recording.stalls import stalls, stalls_in_words
from nxt_twin.recording.stream import RecordingWriter
from nxt_twin.twin.driver import Driver, ProgramDriver
from nxt_twin.twin.logbook import Beat, Logbook, columns_to_fill
from nxt_twin.twin.polling import Plan
from nxt_twin.twin.settings import Pace, pace_of

_TOLD_EVERY_S = 0.5


@final
class RecordedRun(TypedDict):
    """The file of a recording, if there is one, its rows, and its length."""

    file: str | None
    rows: int
    seconds: float


def record(
    url: Annotated[str | None, typer.Argument(help="As for connect; without: the first brick found.")] = None,
    out: Annotated[Path | None, typer.Option(help="The recording: .parquet or .csv.", metavar="FILE")] = None,
    ports: Annotated[str, typer.Option(help="Motors to read.")] = "abc",
    sensors: Annotated[str, typer.Option(help="Such as 1:touch,4:ultrasonic; or none.")] = NOTHING,
    program: Annotated[
        str | None,
        typer.Option(help="Run a motor program once: a name (nxt-twin drive lists them) or a YAML file."),
    ] = None,
    seconds: Annotated[
        float, typer.Option(min=0.0, help="Length, s; 0: until the program ends, or Ctrl-C.")
    ] = 0.0,
    period: Annotated[
        float, typer.Option(min=0.0, help="Time between polls, s; 0: as fast as the link allows.")
    ] = 0.01,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before motors turn.")] = False,
    json: JsonOption = None,
) -> None:
    """Record a brick: motors, sensors and battery, one row a poll (docs/formats.md).

    Each row goes to the disk at once; after a crash, `nxt-twin recover FILE` restores the rows. Without a program the
    command only reads the motors and their powers. Ctrl-C ends the recording, with exit status 0.
    """
    if out is None:
        raise typer.BadParameter("is missing: name a file for the recording", param_hint="--out")
    wanted, plan = wanted_ports(ports), Plan(sensors=wanted_sensors(sensors), period_s=period)
    driver = None if program is None else ProgramDriver(load_program(program))
    if driver is not None:
        wanted = tuple(dict.fromkeys((*wanted, *driver.ports)))
        seconds = min(seconds or driver.duration_s, driver.duration_s)
    found = chosen_url(url, SystemClock())
    clock = _clock_of(found, bounded=bool(seconds))
    if driver is not None:
        get_leave(found, driver.ports, yes=yes)
    written = write_down(
        lambda: opened(found, clock),
        clock,
        out,
        wanted,
        plan,
        driver=driver,
        pace=pace_of(found),
        seconds=seconds or None,
    )
    if json:
        emit_json(json, json_format.dumps({"schema": "nxt-twin/record/1", **written}))
    if json != "-":
        print(f"{written['rows']} rows, {written['seconds']:.1f} s: {written['file'] or 'nothing recorded'}")
    if written["file"]:
        remark_on_stalls(out)


def remark_on_stalls(path: Path) -> None:
    """Say on standard error where the host or the link stood still while this recording was made."""
    if words := stalls_in_words(stalls(read_recording(path))):
        fail(f"{path}: {words}. Record again while the host is idle")


def _clock_of(url: str, *, bounded: bool) -> Clock:
    """A mock brick in this process lives in virtual time, so that a slow machine costs no row."""
    if not url.startswith("mock:"):
        return SystemClock()
    tell_of_compiling()
    return PacedClock(SystemClock(), math.inf if bounded else 1.0)


def opened(url: str, clock: Clock) -> Brick:
    """The brick of that URL.

    Raises:
        typer.BadParameter: it is no URL.
        LinkRefusedError: the link cannot be opened.
    """
    try:
        return open_brick(url, clock, OPENERS)
    except LinkUrlError as error:
        raise typer.BadParameter(str(error), param_hint="URL") from error


def write_down(
    open_it: Callable[[], AbstractContextManager[Brick]],
    clock: Clock,
    out: Path,
    ports: tuple[Port, ...],
    plan: Plan,
    *,
    pace: Pace,
    driver: Driver | None = None,
    seconds: float | None = None,
    may_end: bool = True,
) -> RecordedRun:
    """Record, with progress; with `may_end` an interrupt ends it as if time were over.

    Whatever else ends it, what was recorded until then is kept, and beside it by how much rows are off their stamps.
    """
    with RecordingWriter(out, columns_to_fill(ports, plan.sensors)) as writer, progress("recording") as tell:
        teller = Teller(tell)
        with suppress(*([KeyboardInterrupt] if may_end else [])), tidy_end(), open_it() as brick:
            logbook = Logbook(brick, clock, ports, plan, writer, driver, pace)
            writer.keep_lags(logbook.row_lags)
            logbook.keep(seconds, teller)
    last = teller.last
    return RecordedRun(file=str(out) if last.rows else None, rows=last.rows, seconds=round(last.elapsed_s, 3))


@final
class Teller:
    """Shows now and then how far a logbook is.

    Args:
        tell: shows words.

    Attributes:
        last: how far it came.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._due_s = 0.0
        self.last = Beat(0.0, 0)

    def __call__(self, beat: Beat) -> None:
        """Take what a logbook says after each poll."""
        self.last = beat
        if beat.elapsed_s >= self._due_s:
            self._due_s = beat.elapsed_s + _TOLD_EVERY_S
            self._tell(f"{beat.elapsed_s:.0f} s, {beat.rows} rows")
