"""The program `nxt-twin`: its commands and its exit statuses.

0 done; 1 the thing asked for failed, with one line on standard error; 2 wrong use.
"""

from __future__ import annotations

import sys

import typer

from nxt_twin.errors import NxtTwinError

app = typer.Typer(
    name="nxt-twin",
    help="A digital twin for the LEGO Mindstorms NXT that finds the physics its model leaves out.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=True,
)


def main() -> None:
    """Run the program and leave with its exit status."""
    try:
        app()
    except NxtTwinError as error:
        print(f"nxt-twin: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print("nxt-twin: interrupted", file=sys.stderr)
        sys.exit(130)
