"""`nxt-twin identify`: carry an experiment out, fit, and write a plant or sensor configuration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption


def identify(
    experiment: Annotated[
        str | None,
        typer.Argument(help="An experiment: a name or a YAML file; without: list the names."),
    ] = None,
    url: Annotated[
        str | None,
        typer.Argument(help="The brick: usb:, bt:ADDRESS, tcp:HOST:PORT, mock: …; without: the first found."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder of the run; an unfinished run continues."),
    ] = None,
    positioner: Annotated[
        list[str] | None,
        typer.Option(
            help="The positioner: hand (asks you), rail:PORT,mm_per_deg=…, nx100:HOST,along=…,value_now=…;"
            " AXIS= before it, such as angle_deg=hand, names one of several axes."
        ),
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print the plan, and do nothing.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before motors turn.")] = False,
    json: JsonOption = None,
) -> None:
    """Carry out an experiment on a brick, fit what it recorded, and write plant.yaml or sensor.yaml.

    On `mock:` a software rig moves the target in virtual time. On a real brick you are asked before motors turn. After
    Ctrl-C the motors coast and the positioners stop. A second run with this --out continues the experiment.
    """
    # A second of imports that the help does not need.
    from nxt_twin.cli.identifying import IdentifyArguments, carry_on, list_experiments

    if experiment is None:
        list_experiments(json)
        return
    tell_of_compiling()
    carry_on(IdentifyArguments(experiment, url, out, tuple(positioner or ()), dry_run, yes, json))
