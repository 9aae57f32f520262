"""The program `nxt-twin`: its commands and its exit statuses.

0 done; 1 the thing asked for failed, with one line on standard error; 2 wrong use.
"""

from __future__ import annotations

import sys

import typer

from nxt_twin.cli.blind import blind
from nxt_twin.cli.demo import demo
from nxt_twin.cli.diagnose import diagnose
from nxt_twin.cli.fit import fit
from nxt_twin.cli.output import fail
from nxt_twin.cli.prepare import prepare
from nxt_twin.cli.simulate import simulate
from nxt_twin.errors import NxtTwinError

_INTERRUPTED = 130

app = typer.Typer(
    name="nxt-twin",
    help="A digital twin for the LEGO Mindstorms NXT that finds the physics its model leaves out.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
for command in (diagnose, simulate, fit, prepare, demo):
    app.command()(command)
app.add_typer(blind, name="blind")


def main() -> None:
    """Run the program and leave with its exit status."""
    try:
        app(_with_json_target(sys.argv[1:]))
    except NxtTwinError as error:
        fail(str(error))
        sys.exit(1)
    except OSError as error:
        fail(f"{error.filename or 'file'}: {error.strerror or error}")
        sys.exit(1)
    except KeyboardInterrupt:
        fail("interrupted")
        sys.exit(_INTERRUPTED)


def _with_json_target(arguments: list[str]) -> list[str]:
    """`--json` with nothing after it means standard output."""
    completed: list[str] = []
    for argument, following in zip(arguments, [*arguments[1:], "--"], strict=True):
        completed.append(argument)
        if argument == "--json" and following.startswith("--"):
            completed.append("-")
    return completed
