"""`nxt-twin replay`: a recording beside a model, as if the brick were there."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption
from nxt_twin.cli.showing import Showing, ViewChoice

_SCHEMA = "nxt-twin/replay/1"


def replay(
    recording: Annotated[Path, typer.Argument(help="A brick's recording: .csv or .parquet.")],
    model: Annotated[
        str | None,
        typer.Option(
            help="Model of the motors: a name or a YAML file; without: the sidecar's, or nxt_motor."
        ),
    ] = None,
    ports: Annotated[
        str | None, typer.Option(help="Ports of the motors to watch; without: every recorded motor.")
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.0, help="Speed as a multiple of real time; 0: as fast as possible.")
    ] = 1.0,
    adopt: Annotated[
        bool, typer.Option("--adopt", help="Diagnose a divergence and adopt the improved model.")
    ] = False,
    view: Annotated[ViewChoice, typer.Option(help="Dashboard: a window, in the browser, or none.")] = "none",
    save: Annotated[Path | None, typer.Option(help="Keep the dashboard's data: .rrd.")] = None,
    model_out: Annotated[
        Path | None, typer.Option(help="Write the adopted plant of each motor as YAML.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Play a recording to the live twin, with the filters and the monitor of a live session.

    Exit status 0 after any verdict, as with live.
    """
    from nxt_twin.cli.replaying import (
        ReplayArguments,
        replay_beside,
    )  # a second of imports that the help does not need

    showing = Showing(
        title=recording.name,
        schema=_SCHEMA,
        view=view,
        save=save,
        model_out=model_out,
        json=json,
        lossless=True,
    )
    tell_of_compiling()
    replay_beside(recording, ReplayArguments(model, ports, speed, adopt), showing)
