"""The program `nxt-twin`: its commands and its exit statuses.

0 done; 1 the thing asked for failed or was interrupted, with one line on standard error; 2 wrong use.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterable, Mapping
from importlib import import_module
from itertools import pairwise
from types import MappingProxyType
from typing import Annotated, NoReturn

import typer

from nxt_twin import __version__
from nxt_twin.cli.output import fail
from nxt_twin.errors import NxtTwinError
from nxt_twin.threads import ask_for_one_thread

_PAGES = "Files, JSON and exit statuses: docs/formats.md. The physical effects: docs/effects.md."
_COMPLETION = "_NXT_TWIN_COMPLETE"  # what a shell sets to be told how a line can go on
_OBJECTS_BETWEEN_COLLECTIONS = 100_000  # an eighth of a start went into collections that freed nothing
_INTERRUPTED_WITHIN = 130  # what typer leaves with, without a word, when a command is interrupted

COMMANDS: Mapping[str, str] = MappingProxyType(
    {
        "tour": "Be led through the first minutes, on a mock brick.",
        "demo": "Watch the whole loop without hardware.",
        "diagnose": "Find the physics that a model leaves out, from recordings.",
        "changed": "Say what differs between recordings made before and after.",
        "simulate": "Predict a recording's outputs from its inputs.",
        "fit": "Fit a plant's parameters to a case; look for nothing else.",
        "map": "Guess what the columns of a table are, and write the mapping.",
        "identify": "Carry out an experiment on a brick and write the fitted plant or sensor.",
        "prepare": "Make a case of a real data set that is on this machine.",
        "fleet": "Diagnose many recordings of many units.",
        "blind": "Make, solve and score cases with concealed effects.",
        "reproduce": "Recompute the source paper and say where it contradicts itself.",
        "connect": "Talk to a brick, or search for bricks.",
        "live": "Watch a brick beside its model.",
        "record": "Record a brick's motors, sensors and battery.",
        "stop": "Let all motors of a brick coast.",
        "recover": "Get back what a crash left of a recording.",
        "replay": "Play a recording to the live twin.",
        "drive": "Run a motor program on a brick.",
        "mock": "Serve a mock brick until interrupted.",
        "world": "Run a program for a brick on a simulated robot.",
        "export": "Write an identified motor or a recording for another program.",
        "udev": "Print the udev rule that gives you access to a brick on USB.",
        "doctor": "Find what on this machine keeps a brick from being reached.",
    }
)
"""What each command does, by its name. A command is a module of this package that holds a function, or a program of
its own, of that name."""


def program(commands: Iterable[str] = COMMANDS) -> typer.Typer:
    """The program with these commands, each imported."""
    app = _empty()
    for name in commands:
        command = getattr(import_module(f"nxt_twin.cli.{name}"), name)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name, short_help=COMMANDS[name])
        else:
            app.command(name, short_help=COMMANDS[name])(command)
    return app


def contents() -> typer.Typer:
    """The program as its own help needs it: every command's summary, and no command imported."""
    app = _empty()
    for name, summary in COMMANDS.items():
        app.command(name, help=summary)(_only_listed)
    return app


def _empty() -> typer.Typer:
    app = typer.Typer(name="nxt-twin", no_args_is_help=True, pretty_exceptions_enable=False, epilog=_PAGES)
    app.callback()(_about)
    return app


def _only_listed() -> None:
    """Stands for a command in the list of commands."""


def _wanted(arguments: list[str]) -> typer.Typer:
    """The program with as few commands imported as these arguments need."""
    named = next((argument for argument in arguments if not argument.startswith("-")), "")
    if named in COMMANDS:
        return program([named])
    return program() if _COMPLETION in os.environ else contents()


def main() -> None:
    """Run the program and leave with its exit status."""
    ask_for_one_thread()
    gc.set_threshold(_OBJECTS_BETWEEN_COLLECTIONS)
    arguments = _with_json_target(sys.argv[1:])
    try:
        _wanted(arguments)(arguments)
    except NxtTwinError as error:
        fail(str(error))
        sys.exit(1)
    except OSError as error:
        fail(str(NxtTwinError(error.strerror or str(error), where=str(error.filename or "file"))))
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


def _tell_version(wanted: bool) -> None:
    if wanted:
        print(f"nxt-twin {__version__}")
        raise typer.Exit


def _about(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """A digital twin for the LEGO Mindstorms NXT that finds the physics its model leaves out."""


def _with_json_target(arguments: list[str]) -> list[str]:
    """`--json` with nothing after it means standard output."""
    completed: list[str] = []
    for argument, following in pairwise([*arguments, "--"]):
        completed.append(argument)
        if argument == "--json" and following.startswith("--"):
            completed.append("-")
    return completed
