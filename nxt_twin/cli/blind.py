"""`nxt-twin blind`: the concealed-effect benchmark: make cases, solve them, score the answers."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.make import make_set
from nxt_twin.blind.polling import Link
from nxt_twin.blind.score import score as score_answers
from nxt_twin.blind.sets import plan_set
from nxt_twin.cli.output import JsonOption, emit_json, fail, progress
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.to_json import to_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.case import read_case

_LINKS: dict[str, tuple[Link, ...]] = {
    "usb": ("usb",),
    "bluetooth": ("bluetooth",),
    "both": ("usb", "bluetooth"),
}

blind = typer.Typer(no_args_is_help=True, help="The concealed-effect benchmark: make, solve and score cases.")


@blind.command()
def make(
    cases: Annotated[Path, typer.Argument(help="Folder for the cases.")],
    answers: Annotated[Path, typer.Argument(help="Another folder, for the sealed answers.")],
    seed: Annotated[int, typer.Option(help="Of the whole set.")] = 1,
    effects: Annotated[str | None, typer.Option(help="Only these ids, comma-separated.")] = None,
    clean: Annotated[int, typer.Option(min=0, help="Cases in which nothing is missing.")] = 40,
    pairs: Annotated[int, typer.Option(min=0, help="Cases with two effects.")] = 30,
    triples: Annotated[int, typer.Option(min=0, help="Cases with three effects.")] = 10,
    unknown: Annotated[int, typer.Option(min=0, help="Cases with an effect that no library holds.")] = 10,
    link: Annotated[str, typer.Option(help="usb, bluetooth, or both in turn.")] = "both",
    duration: Annotated[float, typer.Option(min=5.0, help="Length of a recording, s.")] = 15.0,
) -> None:
    """Make a set of cases: every effect in three sizes, clean ones, combinations, and unknown ones."""
    if link not in _LINKS:
        raise typer.BadParameter(f"'{link}' is none of {', '.join(_LINKS)}", param_hint="--link")
    chosen = tuple(effects.split(",")) if effects else tuple(KNOWN_EFFECTS)
    plans = plan_set(seed, effects=chosen, clean=clean, pairs=pairs, triples=triples, unknown=unknown)
    making = make_set(plans, cases, answers, links=_LINKS[link], duration_s=duration)
    with progress("making cases") as tell:
        for number, folder in enumerate(making, start=1):
            tell(f"{folder.name}, {number} of {len(plans)}")
    print(f"{len(plans)} cases in {cases}, answers in {answers}")


@blind.command()
def solve(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases.")],
    out: Annotated[Path, typer.Argument(help="Folder for one JSON a case.")],
    seed: Annotated[int, typer.Option(help="Of the diagnoses.")] = 0,
) -> None:
    """Diagnose every case of a folder; cases that have their JSON already are passed over."""
    out.mkdir(parents=True, exist_ok=True)
    failed = False
    folders = sorted(folder for folder in cases.iterdir() if (folder / "case.yaml").exists())
    with progress("solving") as tell:
        for number, folder in enumerate(folders):
            target = out / f"{folder.name}.json"
            tell(f"{folder.name}, {number + 1} of {len(folders)}")
            if target.exists():
                continue
            try:
                answer = diagnose(read_case(folder), seed=seed)
            except NxtTwinError as error:
                fail(str(error))
                failed = True
                continue
            target.write_text(to_json(answer.diagnosis), encoding="utf-8")
    print(f"{len(folders)} cases, diagnoses in {out}")
    if failed:
        raise typer.Exit(1)


@blind.command()
def score(
    cases: Annotated[Path, typer.Argument(help="Folder of the cases, which carry the seals.")],
    answers: Annotated[Path, typer.Argument(help="Folder of the answers.")],
    diagnoses: Annotated[Path, typer.Argument(help="Folder of the diagnoses.")],
    json: JsonOption = None,
) -> None:
    """Hold diagnoses against the sealed answers and print the table."""
    table = score_answers(cases, answers, diagnoses)
    if json:
        emit_json(json, json_format.dumps(table.as_dict()))
    if json != "-":
        print(table.as_text())
