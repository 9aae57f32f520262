"""`nxt-twin changed`: say what differs between recordings made before and after.

Its imports stand inside the functions: help comes at once, without the compiler and the engine.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, progress, remark
from nxt_twin.cli.tables import ColumnsOption, MappingOption, stated_mapping
from nxt_twin.cli.tolerated import ToleranceOption, tolerated

if TYPE_CHECKING:
    from nxt_twin.diagnose.changed.answer import Changes
    from nxt_twin.recording.case import Case
    from nxt_twin.recording.mappings import MappingOf


def changed(
    before: Annotated[
        str, typer.Argument(help="A case folder, a recording, or recordings separated by commas.")
    ],
    afters: Annotated[
        list[str],
        typer.Argument(metavar="AFTER...", help="As BEFORE; each AFTER is compared with BEFORE."),
    ],
    json: JsonOption = None,
    report: Annotated[
        Path | None, typer.Option(help="Write an HTML page for each AFTER into this folder.")
    ] = None,
    plant: Annotated[
        str | None, typer.Option(help="The model of both sides; without: from BEFORE's case or sidecar.")
    ] = None,
    mapping: MappingOption = None,
    columns: ColumnsOption = None,
    tolerance: ToleranceOption = None,
) -> None:
    """Say which parameters or effects differ between recordings made before and after, if any.

    Exit status 0 after any verdict; 1 if the sides cannot be compared.
    """
    from nxt_twin.diagnose.changed.to_json import to_json
    from nxt_twin.diagnose.dispatch import changed_any as compare
    from nxt_twin.view.changes_report import write_changes_report

    error_si = tolerated(tolerance)
    tell_of_compiling()
    mapping_of = stated_mapping(mapping, columns)
    with progress(f"{before} and after") as tell:
        first = _side(before, plant, mapping_of)
        others = [_side(each, plant, mapping_of) for each in afters]
        found = compare(first, _apart(first, others), tolerance=error_si, progress=tell)
    if len(found) > 1:
        _tell_among(found, json)
    for each in found:
        if json:
            many = len(found) > 1 and json != "-"
            emit_json(str(Path(json) / f"{each.name}.json") if many else json, to_json(each))
        page = write_changes_report(each, report) if report else None
        if json != "-":
            show(each, page)


def _tell_among(found: list[Changes], json: str | None) -> None:
    """Say which of several units differs in what, and write it beside the files of each."""
    from nxt_twin.diagnose.changed.among import among, to_json

    units = among(found)
    if json and json != "-":
        emit_json(str(Path(json) / "units.json"), to_json(units))
    if json != "-":
        print(units.sentence)


def show(changes: Changes, page: Path | None) -> None:
    """Print what changed for a person, and where its page lies."""
    from nxt_twin.diagnose.units import after_number

    fit = changes.fit
    print(f"\n{changes.before} → {changes.name}: {changes.verdict}")
    print(changes.sentence)
    print(f"  {fit.metric}: {fit.baseline:.3g} → {fit.improved:.3g} {fit.unit} (of its own {fit.floor:.3g})")
    for change in changes.changes:
        unit = after_number(change.unit)
        low, high = change.interval_95
        came = "not there" if change.before is None else f"{change.before:.4g}"
        print(
            f"  {change.of}: {came} → {change.after:.4g}{unit} "
            f"(95 %: {low:.4g} to {high:.4g}), probability {change.probability:.3f}"
        )
    print("  shared by both sides")
    for name, moved in changes.refit.items():
        print(
            f"    {name} {moved.before:.4g} → {moved.after:.4g} ± {moved.std:.2g}{after_number(moved.unit)}"
        )
    for note in changes.notes:
        print(f"  · {note}")
    if page:
        print(f"  report: {page}")


def _side(paths: str, plant: str | None, mapping_of: MappingOf | None) -> Case:
    """One side: a case, or recordings between commas."""
    from nxt_twin.recording.case import read_as_case

    parts = [Path(part) for part in paths.split(",") if part]
    if not parts:
        raise typer.BadParameter("a side names no recording")
    cases = [read_as_case(part, mapping_of) for part in parts]
    for case in cases:
        remark(case)
    found = [(n, each) for n, case in enumerate(cases) for each in case.recordings]
    names = Counter(each.name for _, each in found)
    recordings = tuple(
        replace(each, name=f"{parts[n]}:{each.name}") if names[each.name] > 1 else each for n, each in found
    )
    holdout = tuple(recording for case in cases for recording in case.holdout)
    more = f" and {len(parts) - 1} more" if len(parts) > 1 else ""
    whole = replace(cases[0], name=cases[0].name + more, recordings=recordings, holdout=holdout)
    return whole if plant is None else replace(whole, plant=plant)


def _apart(first: Case, others: list[Case]) -> list[Case]:
    """The sides after, numbered where they would be confused with another."""
    names = [first.name, *(other.name for other in others)]
    return [
        replace(other, name=f"{other.name} ({number})") if names.count(other.name) > 1 else other
        for number, other in enumerate(others, start=2)
    ]
