"""The program `nxt-twin`: its commands and its exit statuses.

0 done; 1 the thing asked for failed or was interrupted, with one line on standard error; 2 wrong use.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from importlib import import_module
from typing import NoReturn

import typer

from nxt_twin.cli.output import fail
from nxt_twin.errors import NxtTwinError

_INTERRUPTED_WITHIN = 130  # what typer leaves with, without a word, when a command is interrupted

COMMANDS = (
    "demo",
    "diagnose",
    "simulate",
    "fit",
    "identify",
    "prepare",
    "blind",
    "reproduce",
    "connect",
    "live",
    "record",
    "recover",
    "replay",
    "drive",
    "mock",
    "udev",
    "doctor",
)
"""Each is a module of this package that holds a function, or a program of its own, of the same name."""


def program(commands: Iterable[str] = COMMANDS) -> typer.Typer:
    """The program with these commands; a command's module, and all that it needs, is only imported for it."""
    app = typer.Typer(name="nxt-twin", no_args_is_help=True, pretty_exceptions_enable=False)
    app.callback()(_about)
    for name in commands:
        command = getattr(import_module(f"nxt_twin.cli.{name}"), name)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name)
        else:
            app.command(name)(command)
    return app


def main() -> None:
    """Run the program and leave with its exit status."""
    arguments = _with_json_target(sys.argv[1:])
    wanted = [arguments[0]] if arguments and arguments[0] in COMMANDS else COMMANDS
    try:
        program(wanted)(arguments)
    except NxtTwinError as error:
        fail(str(error))
        sys.exit(1)
    except OSError as error:
        fail(f"{error.filename or 'file'}: {error.strerror or error}")
        sys.exit(1)
    except KeyboardInterrupt:
        _interrupted()
    except SystemExit as leaving:
        if leaving.code == _INTERRUPTED_WITHIN:
            _interrupted()
        raise


def _interrupted() -> NoReturn:
    fail("interrupted")
    sys.exit(1)


def _about() -> None:
    """A digital twin for the LEGO Mindstorms NXT that finds the physics its model leaves out."""


def _with_json_target(arguments: list[str]) -> list[str]:
    """`--json` with nothing after it means standard output."""
    completed: list[str] = []
    for argument, following in zip(arguments, [*arguments[1:], "--"], strict=True):
        completed.append(argument)
        if argument == "--json" and following.startswith("--"):
            completed.append("-")
    return completed
