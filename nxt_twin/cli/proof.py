"""`nxt-twin blind proof`: a named range over all truth families, in pieces of any length, and its tables."""

from __future__ import annotations

import json as json_format
import os
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.follow import followed
from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.errors import NxtTwinError

if TYPE_CHECKING:
    from nxt_twin.blind.proof import Proof


def proof(
    folder: Annotated[Path, typer.Argument(help="Folder for all files; a second run continues.")],
    chosen: Annotated[
        str,
        typer.Option(
            "--range", help="A named range, such as sample or development; docs/proof.md lists all."
        ),
    ] = "sample",
    family: Annotated[str, typer.Option(help="Truth families, comma-separated, or all.")] = "all",
    minutes: Annotated[
        float | None, typer.Option(min=0.0, help="Minutes after which no case begins; 0 prints the tables.")
    ] = None,
    cases: Annotated[
        int | None, typer.Option(min=1, help="Only this number of cases, from the first on.")
    ] = None,
    peers: Annotated[bool, typer.Option(help="Let other methods answer the cases, too.")] = True,
    jobs: Annotated[int, typer.Option(min=1, help="Processes that share the work.")] = os.cpu_count() or 1,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler; its workers see the folder.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Make, solve and score a named range, and print its tables; a second run continues.

    Cases run in an order of which every beginning is a fair sample of families, kinds and sizes.
    """
    # Each process does one case at a time: a second BLAS thread would only spin.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from nxt_twin.blind.families.orders import families_of
    from nxt_twin.blind.families.table import FAMILIES
    from nxt_twin.blind.proof import Proof
    from nxt_twin.blind.ranges import RANGES
    from nxt_twin.fleet.workers.place import place_of

    if chosen not in RANGES:
        raise typer.BadParameter(f"'{chosen}' is none of {', '.join(RANGES)}", param_hint="--range")
    names = tuple(FAMILIES) if family == "all" else tuple(family.split(","))
    work = Proof(folder, RANGES[chosen], families_of(names), cases)
    tell_of_compiling()
    others = peers and find_spec("pysindy") is not None
    place, goes_on = place_of(jobs, cluster), _until(minutes)
    outcomes = work.run(place, time.process_time, goes_on, peers=others)
    failed = followed("proving", outcomes, len(work.waiting()))
    deletions = work.delete(place, time.process_time, goes_on)
    failed |= followed("without the effect", deletions, len(work.undeleted()))
    _tell(work, folder, chosen, json)
    if failed:
        raise typer.Exit(1)


def _tell(work: Proof, folder: Path, chosen: str, json: str | None) -> None:
    """Write and print the tables of the finished cases."""
    from nxt_twin.blind.tables import as_text, as_values, proof_status, tables_of

    if not work.finished():
        raise NxtTwinError(
            f"holds no finished case of the range {chosen}", where=str(folder), mend="give it more --minutes"
        )
    tables, status = tables_of(work), proof_status(work)
    text = "\n".join([f"{status}\n", *(f"{name}\n\n{as_text(rows)}" for name, rows in tables.items())])
    (folder / "tables.txt").write_text(text, encoding="utf-8")
    if json:
        values = {name: as_values(rows) for name, rows in tables.items()}
        held = {"schema": "nxt-twin/proof/1", "range": chosen, "status": status.splitlines(), **values}
        emit_json(json, json_format.dumps(held))
    if json != "-":
        print(text)


def _until(minutes: float | None) -> Callable[[], bool]:
    """Whether there is time to begin another case."""
    if minutes is None:
        return lambda: True
    end_s = time.monotonic() + 60.0 * minutes
    return lambda: time.monotonic() < end_s
