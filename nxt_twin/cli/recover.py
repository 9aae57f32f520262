"""`nxt-twin recover`: get back what a crash left of a recording."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.recording.stream import STREAM_SUFFIX
from nxt_twin.recording.stream import recover as recovered


def recover(
    recording: Annotated[
        Path, typer.Argument(help=f"The recording that was cut off, or its {STREAM_SUFFIX} file.")
    ],
    json: JsonOption = None,
) -> None:
    """Make a recording out of the stream that a crash, a kill or an empty laptop battery left of it."""
    saved = recovered(recording)
    path = recording.with_name(saved.name)
    if json:
        answer = {"file": str(path), "rows": saved.rows, "seconds": round(saved.duration_s, 3)}
        emit_json(json, json_format.dumps({"schema": "nxt-twin/recover/1", **answer}))
    if json != "-":
        print(f"{saved.rows} rows, {saved.duration_s:.1f} s: {path}")
