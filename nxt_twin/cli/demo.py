"""`nxt-twin demo`: a mock brick conceals something, its twin notices and finds it, and then the truth is told."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption
from nxt_twin.cli.showing import ViewChoice


def demo(
    out: Annotated[Path, typer.Option(help="Folder for the demo's files.")] = Path("build/demo"),
    seed: Annotated[int, typer.Option(min=0, help="Random seed; it draws the concealed effect.")] = 7,
    seconds: Annotated[
        float,
        typer.Option(min=20.0, help="Longest session, s; it ends sooner once the improved model holds."),
    ] = 60.0,
    conceal: Annotated[
        str | None,
        typer.Option(help="The effect to conceal, by id, or 'nothing'; without: drawn.", metavar="ID"),
    ] = None,
    view: Annotated[ViewChoice, typer.Option(help="Dashboard: a window, in the browser, or none.")] = "none",
    json: JsonOption = None,
) -> None:
    """Watch the whole loop without hardware.

    The demo serves a mock brick over TCP. A simulator that shares no formula with the model moves motor A and conceals
    an effect in it. The live twin notices the divergence and diagnoses the recording. It adopts the improved model, and
    brick and model agree again. The demo then prints the concealed effect.
    """
    from nxt_twin.cli.demonstration import (
        DemoArguments,
        demonstrate,
    )  # a second of imports that the help does not need

    tell_of_compiling()
    demonstrate(DemoArguments(out, seed, seconds, conceal, view, json))
