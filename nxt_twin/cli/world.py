"""`nxt-twin world`: a robot in its world, in virtual time."""

from __future__ import annotations

import contextlib
import json as json_format
import sys
import time
from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption, emit_json, fail
from nxt_twin.mock.serve.profile import LinkProfile


def world(
    file: Annotated[str, typer.Argument(help="A world file with a robot, or the name of a built-in world.")],
    program: Annotated[
        Path | None, typer.Option(metavar="SCRIPT", help="A Python program that drives a brick on USB.")
    ] = None,
    argument: Annotated[
        list[str] | None, typer.Option(help="An argument of the program; may be given again.")
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(min=0.0, help="Longest run by the program's clock, s; without a program: the length."),
    ] = 120.0,
    trace: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the robot's path as a recording.")
    ] = None,
    film: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Film the robot: .mp4, .gif, .webp or .png.")
    ] = None,
    save: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write all motions for the rerun viewer: .rrd.")
    ] = None,
    ghost: Annotated[
        str | None,
        typer.Option(
            metavar="PLANT", help="A differential_drive plant; also show the pose by the encoders alone."
        ),
    ] = None,
    profile: Annotated[LinkProfile, typer.Option(help="Delays of the link to the brick.")] = "usb",
    seed: Annotated[int, typer.Option(help="Random seed of the sensors' noise.")] = 0,
    json: JsonOption = None,
) -> None:
    """Run an unchanged brick program on a simulated robot, and print how it ended.

    The program finds the brick on USB, as it finds a real one. Time passes as fast as this machine computes.
    Exit status 0 if the program ends by itself, 1 if it fails or runs out of time.
    """
    from nxt_twin.api.worlds import Wanted, Watched
    from nxt_twin.world.arena import open_arena
    from nxt_twin.world.load import load_setting
    from nxt_twin.world.outcome import summary, to_json
    from nxt_twin.world.program import let_pass, run_program

    if program is not None and not program.is_file():
        raise typer.BadParameter(f"there is no program {program}", param_hint="--program")
    tell_of_compiling()
    watched = Watched(arena := open_arena(load_setting(file), seed), Wanted(trace, film, save, ghost))
    began_s = time.monotonic()
    with contextlib.redirect_stdout(sys.stderr) if json == "-" else contextlib.nullcontext():
        if program is None:
            ran = let_pass(arena, seconds)
        else:
            ran = run_program(arena, program, argument or (), limit_s=seconds, link=profile)
    told = watched.concluded(ran, wall_s=time.monotonic() - began_s)
    if json:
        emit_json(json, json_format.dumps(to_json(told)))
    if json != "-":
        print(*summary(told), sep="\n")
    if ran.ending != "done":
        fail(ran.said or f"{program}: still running after {seconds:g} s")
        raise typer.Exit(1)
