"""`nxt-twin udev`: print the udev rule that grants access to bricks on USB."""

from __future__ import annotations

import json as json_format
import sys

from nxt_twin.brick.doctor.udev import RULE_PATH, install_commands, rule_text
from nxt_twin.cli.output import JsonOption, emit_json


def udev(
    json: JsonOption = None,
) -> None:
    """Print the udev rule that lets you use a brick on USB without being root.

    The rule goes to standard output; the commands that install it go to standard error.
    """
    if json:
        answer = {"schema": "nxt-twin/udev/1", "rule": rule_text(), "path": RULE_PATH}
        emit_json(json, json_format.dumps({**answer, "commands": install_commands()}))
    if json == "-":
        return
    print(rule_text(), end="")
    print(f"To put it in force, file {RULE_PATH}:", *install_commands(), sep="\n    ", file=sys.stderr)
