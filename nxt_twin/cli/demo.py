"""`nxt-twin demo`: a motor with one concealed effect is recorded, diagnosed, and only then revealed."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from nxt_twin.blind.effects.library import KNOWN_EFFECTS
from nxt_twin.blind.make import make_case, write_case
from nxt_twin.cli.diagnose import show
from nxt_twin.cli.output import JsonOption, emit_json, progress
from nxt_twin.diagnose.diagnosis import Diagnosis
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.diagnose.to_json import to_json
from nxt_twin.physics.library import library
from nxt_twin.recording.case import read_case
from nxt_twin.view.report import write_report


def demo(
    out: Annotated[Path, typer.Option(help="Folder for the case, its answer and the report.")] = Path(
        "build/demo"
    ),
    seed: Annotated[int, typer.Option(help="Draws the motor and what is concealed in it.")] = 7,
    duration: Annotated[float, typer.Option(min=5.0, help="Length of each recording, s.")] = 12.0,
    conceal: Annotated[
        str | None, typer.Option(help="An effect's id, or 'nothing'; else one is drawn.", metavar="ID")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Conceal one effect in a motor, record it, diagnose the recordings, and then reveal the truth.

    The motor is made by a simulator that shares no formula with the model that is fitted to it.
    """
    concealed = _concealed(conceal, seed)
    name = f"demo-{seed}"
    with progress("demo") as tell:
        tell("recording a motor with something concealed in it")
        case = make_case(seed, effects=concealed, size="medium", duration_s=duration, name=name)
        folder = write_case(case, out / "cases", out / "answers")
        answer = diagnose(read_case(folder), progress=tell)
    page = write_report(answer.diagnosis, out)
    truth = case.answer["effects"]
    if json:
        revealed = {
            "diagnosis": json_format.loads(to_json(answer.diagnosis)),
            "truth": truth,
            "report": str(page),
        }
        emit_json(json, json_format.dumps({"schema": "nxt-twin/demo/1", **revealed}, ensure_ascii=False))
    if json != "-":
        show(answer.diagnosis, page)
        print(f"\nthe truth, revealed only now: {_told(truth)}")
        print(_score(answer.diagnosis, [effect["id"] for effect in truth]))


def _concealed(wanted: str | None, seed: int) -> tuple[str, ...]:
    known = sorted(set(KNOWN_EFFECTS) & set(library()))
    if wanted is None:
        return (str(np.random.default_rng(seed).choice(known)),)
    if wanted not in (*known, "nothing"):
        raise typer.BadParameter(f"'{wanted}' is none of nothing, {', '.join(known)}", param_hint="--conceal")
    return () if wanted == "nothing" else (wanted,)


def _told(truth: list[dict[str, Any]]) -> str:
    if not truth:
        return "nothing was concealed, but the model's parameters were wrong"
    effect = truth[0]
    params = ", ".join(f"{key} = {value:.4g}" for key, value in effect["params"].items())
    return f"{effect['id']} ({params})"


def _score(diagnosis: Diagnosis, truth: list[str]) -> str:
    found = [effect.id for effect in diagnosis.effects]
    near = [other.id for effect in diagnosis.effects for other in effect.confusable_with]
    if found == truth:
        return "named exactly" if truth else "rightly left alone"
    if set(truth) & {*found, *near}:
        return "named, but not alone: see what it could be confused with"
    return "missed"
