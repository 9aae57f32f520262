"""`nxt-twin reproduce`: the source paper's tables and fits, computed beside what it prints."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.paper.reproduction import FROM_FIGURES_ONLY, Reproduction, to_json
from nxt_twin.paper.reproduction import reproduce as recompute


def reproduce(
    json: JsonOption = None,
    report: Annotated[Path | None, typer.Option(help="Write an HTML page with the figures here.")] = None,
) -> None:
    """Recompute the source paper, and say where it contradicts itself."""
    reproduction = recompute()
    page = None
    if report:
        # Brings in the plotting library, which nothing else here needs.
        from nxt_twin.view.paper_page import write_paper_page

        page = write_paper_page(reproduction, report)
    if json:
        emit_json(json, to_json(reproduction))
    if json != "-":
        _show(reproduction)
        if page:
            print(f"\npage: {page}")


def _show(reproduction: Reproduction) -> None:
    console = Console(highlight=False)
    table = Table(title="printed and computed", title_justify="left", box=None, pad_edge=False)
    for heading in ("where", "quantity"):
        table.add_column(heading)
    for heading in ("printed", "computed"):
        table.add_column(heading, justify="right")
    table.add_column("unit")
    table.add_column("")
    for one in reproduction.comparisons:
        mark = "" if one.agrees else "[bold]differs[/bold]"
        table.add_row(one.where, one.quantity, one.printed, one.shown, one.unit, mark)
    console.print(table)
    console.print(f"\n[bold]{len(reproduction.contradictions)} contradictions[/bold]")
    for number, found in enumerate(reproduction.contradictions, 1):
        console.print(f"\n{number}. {found.title} ({found.where}; {found.id})", style="bold")
        console.print(f"   It says: {found.claim}.")
        console.print(f"   Its data say: {found.evidence}.")
        console.print(f"   Probably: {found.cause}.")
        console.print(f"   Used here: {found.used}.")
    console.print("\n[bold]Only as a figure[/bold]")
    for note in FROM_FIGURES_ONLY:
        console.print(f" · {note}")
