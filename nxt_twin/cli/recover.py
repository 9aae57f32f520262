"""`nxt-twin recover`: get back what a crash left of a recording."""

from __future__ import annotations

import json as json_format
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.output import JsonOption, emit_json, fail
from nxt_twin.recording.driven import driven_at_the_end
from nxt_twin.recording.stream import STREAM_SUFFIX, stream_path
from nxt_twin.recording.stream import recover as recovered


def recover(
    recording: Annotated[
        Path, typer.Argument(help=f"The recording that was cut off, or its {STREAM_SUFFIX} file.")
    ],
    json: JsonOption = None,
) -> None:
    """Restore a recording from the stream that a crash left.

    From a damaged stream the command restores all whole rows, keeps the stream, and exits with status 1. It warns if
    the last row drives motors: after a crash of the host, a brick keeps its last command.
    """
    found = recovered(recording)
    saved = found.recording
    path = recording.with_name(saved.name)
    driven = driven_at_the_end(saved)
    if json:
        answer = {"file": str(path), "rows": saved.rows, "seconds": round(saved.duration_s, 3)}
        document = {"schema": "nxt-twin/recover/1", **answer, "damages": found.damages, "driven": driven}
        emit_json(json, json_format.dumps(document))
    if json != "-":
        print(f"{saved.rows} rows, {saved.duration_s:.1f} s: {path}")
    if driven:
        were = ", ".join(f"{port.upper()} at {power_pct:g} %" for port, power_pct in driven.items())
        fail(
            f"the last row drives {were}; a brick that is on goes on so: nxt-twin stop lets its motors coast"
        )
    if found.damages:
        fail(f"{stream_path(path)}: {'; '.join(found.damages)} (the stream is kept)")
        raise typer.Exit(1)
