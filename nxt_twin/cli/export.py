"""`nxt-twin export`: write an identified motor, or a recording, for another program."""

from __future__ import annotations

import json as json_format
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.errors import NxtTwinError
from nxt_twin.export.formats import FormatName


def export(
    source: Annotated[
        str,
        typer.Argument(
            metavar="PLANT|RECORDING",
            help="A plant: a YAML file, or the name of a built-in one; for mcap and rrd, a recording.",
        ),
    ],
    to: Annotated[Literal[FormatName, "mcap", "rrd"], typer.Option("--to", help="The format.")],
    out: Annotated[
        Path | None, typer.Option(help="The file; without, standard output. mcap and rrd need it.")
    ] = None,
    plant: Annotated[str | None, typer.Option(help="Of a recording: add what this plant predicts.")] = None,
    diagnosis: Annotated[
        Path | None, typer.Option(help="Of a recording: add what this JSON of diagnose says.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Write a motor or a recording for another program.

    A motor becomes a URDF joint, a MuJoCo actuator, Simscape's parameters or a Python module. A recording becomes MCAP
    or a file of the rerun viewer. Standard error and comments in the file list the physics that the format cannot hold.
    """
    if to == "mcap" or to == "rrd":
        _export_run(Path(source), to, out, plant, diagnosis)
        if json:
            answer = {"schema": "nxt-twin/export/1", "format": to, "file": str(out)}
            emit_json(json, json_format.dumps({**answer, "left_out": [], "limits": []}))
        return
    if plant is not None or diagnosis is not None:
        raise typer.BadParameter("is for recordings: --to mcap or rrd", param_hint="--plant, --diagnosis")
    _export_plant(source, to, out, json)


def _export_plant(model: str, to: FormatName, out: Path | None, json: str | None) -> None:
    from nxt_twin.api.files import load_plant
    from nxt_twin.export.axis import axis_of, check_kind
    from nxt_twin.export.formats import export as write
    from nxt_twin.recording.configs import load_plant_config

    check_kind(load_plant_config(model), model)
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


def _export_run(
    source: Path, to: Literal["mcap", "rrd"], out: Path | None, plant: str | None, diagnosis: Path | None
) -> None:
    from nxt_twin.api.files import read_recording
    from nxt_twin.export.run import drawn_run

    if out is None:
        raise typer.BadParameter(f"{to} is written to a file", param_hint="--out")
    recording = read_recording(source)
    predicted = {}
    if plant is not None:
        from nxt_twin.api.prediction import predictions
        from nxt_twin.recording.configs import load_plant_config

        found = predictions(load_plant_config(plant), recording, None)
        predicted = {each.channel: each.values for each in found}
    run = drawn_run(recording, predicted, None if diagnosis is None else _read_json(diagnosis))
    if to == "mcap":
        from nxt_twin.export.mcap_run import write_mcap

        write_mcap(run, out)
    else:
        from nxt_twin.view.dashboard.drawing.run_file import write_rrd

        write_rrd(run, out)


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json_format.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        content = None
    if not isinstance(content, dict):
        mend = "name a file of nxt-twin diagnose --json"
        raise NxtTwinError("is no diagnosis", where=str(path), mend=mend)
    return content
