"""`nxt-twin udev`: print the udev rule that grants access to bricks on USB."""

from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from nxt_twin.brick.doctor.udev import RULE_PATH, install_commands, rule_text


def udev(
    as_json: Annotated[bool, typer.Option("--json", help="Print rule, path and commands as JSON.")] = False,
) -> None:
    """Print the udev rule that lets you use a brick on USB without being root.

    The rule goes to standard output, to be piped into its file; how to do that goes to standard error.
    """
    if as_json:
        print(json.dumps({"rule": rule_text(), "path": RULE_PATH, "commands": install_commands()}))
        return
    print(rule_text(), end="")
    print(f"To put it in force, file {RULE_PATH}:", *install_commands(), sep="\n    ", file=sys.stderr)
