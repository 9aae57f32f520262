"""`nxt-twin fleet`: many recordings of many units.

Its imports stand inside the functions: help comes at once, without the compiler and the engine.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, fail
from nxt_twin.cli.tolerated import ToleranceOption, tolerated

if TYPE_CHECKING:
    from nxt_twin.fleet.run import FleetTally

fleet = typer.Typer(no_args_is_help=True, help="Many recordings of many units.")


@fleet.callback()
def _about() -> None:
    """Diagnose many recordings of many units."""


@fleet.command()
def diagnose(
    places: Annotated[
        list[str],
        typer.Argument(
            metavar="FOLDER...", help="Folders, files, globs, or URLs of either; below them UNIT/SESSION."
        ),
    ],
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler whose workers do the work.")
    ] = None,
    out: Annotated[Path, typer.Option(metavar="TABLE", help="The table; its rows are kept.")] = Path(
        "fleet.parquet"
    ),
    jobs: Annotated[int, typer.Option(min=1, help="Processes of this machine that share the work.")] = (
        os.cpu_count() or 1
    ),
    report: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write a page on the whole table into this folder.")
    ] = None,
    json: JsonOption = None,
    seed: Annotated[int, typer.Option(help="Of the random shifts behind p-values.")] = 0,
    tolerance: ToleranceOption = None,
) -> None:
    """Diagnose every session of every unit, one row each; what an earlier run did is kept.

    A recording that cannot be diagnosed is a row with its error. Exit status 1 only if no session has an answer.
    """
    from nxt_twin.fleet.parcel import Options
    from nxt_twin.fleet.run import diagnose_fleet
    from nxt_twin.fleet.table import FleetTable
    from nxt_twin.fleet.workers.place import Cluster, Processes

    options = Options(seed, tolerated(tolerance))
    place = Cluster(cluster) if cluster else Processes(jobs)
    if not cluster:
        tell_of_compiling()
    with FleetTable(out) as table, _bar() as tell:
        tally = diagnose_fleet(places, table, options, place, tell)
    said = (
        f"{tally.sessions} sessions: {tally.diagnosed} diagnosed, {tally.kept} kept from before, "
        f"{tally.failed} failed; table {out}"
    )
    print(said, file=sys.stderr if json == "-" else sys.stdout)
    _tell_findings(out, json, report)
    if tally.failed == tally.sessions:
        fail(f"no session could be diagnosed (column error of {out} says why)")
        raise typer.Exit(1)


def _tell_findings(table: Path, json: str | None, report: Path | None) -> None:
    """Write what the whole table says, where it is asked for."""
    if json is None and report is None:
        return
    from nxt_twin.fleet.findings.found import findings_in
    from nxt_twin.fleet.findings.to_json import to_json

    findings = findings_in(table)
    if json:
        emit_json(json, to_json(findings, str(table)))
    if report:
        from nxt_twin.view.fleet_page import fleet_sentence, write_fleet_page

        page = write_fleet_page(findings, report, str(table))
        if json != "-":
            print(f"{fleet_sentence(findings)}\n  report: {page}")


@contextmanager
def _bar() -> Iterator[Callable[[FleetTally], None]]:
    """Show on standard error how far it is: a bar on a terminal, a line for each tenth elsewhere."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task("fleet", total=None)

        def tell(tally: FleetTally) -> None:
            failed = f", {tally.failed} failed" if tally.failed else ""
            bar.update(task, total=tally.sessions, completed=tally.ended, description=f"fleet{failed}")
            if bar.disable and tally.sessions >= _FEWEST_TOLD and tally.ended % (tally.sessions // 10) == 0:
                print(f"fleet: {tally.ended} of {tally.sessions}{failed}", file=sys.stderr, flush=True)

        yield tell


_FEWEST_TOLD = 20
