"""`nxt-twin stop`: let all motors of a brick go."""

from __future__ import annotations

import json as json_format
from typing import Annotated

import typer

from nxt_twin.api.openers import LOOKING_OPENERS
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.errors import LinkUrlError
from nxt_twin.brick.open import open_brick
from nxt_twin.brick.portrait import driven
from nxt_twin.cli.output import JsonOption, emit_json
from nxt_twin.cli.wanted import chosen_url


def stop(
    url: Annotated[str | None, typer.Argument(help="As for connect; without: the first brick found.")] = None,
    json: JsonOption = None,
) -> None:
    """Let all motors of a brick coast, and stop the program that runs on it, if one does.

    After a crash of the host or a lost link, a brick keeps its last command. Exit status 1 if it cannot be reached.
    """
    clock = SystemClock()
    found = chosen_url(url, clock)
    try:
        with open_brick(found, clock, LOOKING_OPENERS) as brick:
            program, motors = brick.programs.current().value, driven(brick)
            _let_go(brick, program)
    except LinkUrlError as error:
        raise typer.BadParameter(str(error), param_hint="URL") from error
    if json:
        document = {"schema": "nxt-twin/stop/1", "program": program, "driven": motors}
        emit_json(json, json_format.dumps(document))
    if json != "-":
        if program is not None:
            print(f"the program {program} is stopped")
        were = ", ".join(f"{port} at {power_pct} %" for port, power_pct in motors.items())
        print(f"all motors coast; driven before: {were or 'none'}")


def _let_go(brick: Brick, program: str | None) -> None:
    if program is not None:
        brick.programs.stop()
    brick.motors.coast()
