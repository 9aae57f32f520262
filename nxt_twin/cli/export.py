"""`nxt-twin export`: write an identified motor for another program."""

from __future__ import annotations

import json as json_format
import sys
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.export.formats import FormatName


def export(
    model: Annotated[str, typer.Argument(help="A plant: a YAML file, or the name of a built-in one.")],
    to: Annotated[FormatName, typer.Option("--to", help="The format.")],
    out: Annotated[Path | None, typer.Option(help="The file; without, standard output.")] = None,
    json: JsonOption = None,
) -> None:
    """Write a motor for another program: a URDF joint, a MuJoCo actuator, Simscape's parameters, a Python module.

    Standard error and comments in the file list the physics that the format cannot hold.
    """
    from nxt_twin.api.files import load_plant
    from nxt_twin.export.axis import axis_of
    from nxt_twin.export.formats import export as write

    made = write(axis_of(load_plant(model), Path(model).stem), to)
    if out is not None:
        out.write_text(made.text, encoding="utf-8")
    elif json != "-":
        print(made.text, end="")
    if json:
        answer = {"schema": "nxt-twin/export/1", "format": to, "file": None if out is None else str(out)}
        notes = {"text": made.text, "left_out": made.left_out, "limits": made.limits}
        emit_json(json, json_format.dumps({**answer, **notes}))
    if made.left_out:
        print(f"left out: {', '.join(made.left_out)}", file=sys.stderr)
    for limit in made.limits:
        print(f"note: {limit}", file=sys.stderr)
