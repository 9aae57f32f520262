"""`nxt-twin tour`: the first minutes, step by step, on a mock brick; each command is shown and run."""

from __future__ import annotations

import shlex
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, final

import typer

from nxt_twin.errors import NxtTwinError

_CONCEALED: Final = "port: a\neffects: [constant_load]\nsize: large\nseed: 2\n"
_BRICK: Final = "mock:?conceal=secret.yaml"


@final
@dataclass(frozen=True)
class Stop:
    """One stop of the tour: what is to be seen, and the command that shows it."""

    words: str
    command: tuple[str, ...]


STOPS: Final = (
    Stop(
        "A brick answers. This one is made of software; with yours on USB, write usb: in place of mock:.",
        ("connect", "mock:"),
    ),
    Stop(
        "Its motor A carries a weight that no model knows. Record it: 12 s of motor, in virtual time.",
        ("record", _BRICK, "--ports", "a", "--program", "excitation", "--seconds", "12", "--out", "run.csv"),
    ),
    Stop(
        "Ask what the model of the motor leaves out.",
        ("diagnose", "run.csv", "--report", "report", "--model-out", "better.yaml"),
    ),
    Stop("Reveal what was concealed.", ("blind", "reveal", "secret.yaml")),
    Stop(
        "The better model predicts the recording from its commands alone.",
        ("simulate", "better.yaml", "run.csv", "--out", "predicted.csv"),
    ),
)
"""The tour, in order; every command runs in the tour's folder."""


def tour(
    out: Annotated[
        Path | None, typer.Option(help="Folder for what the tour writes, which stays; else a temporary one.")
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not wait for Enter between the steps.")] = False,
) -> None:
    """Be led through the first minutes: reach a brick, record it, find what its model leaves out.

    Each command is shown and run, on a mock brick. Nothing is written outside the tour's folder.
    """
    with ExitStack() as ending:
        folder = (
            Path(ending.enter_context(tempfile.TemporaryDirectory(prefix="nxt-twin-tour-")))
            if out is None
            else out
        )
        folder.mkdir(parents=True, exist_ok=True)
        if (folder / "run.csv").exists():
            raise NxtTwinError("holds a tour already", where=str(folder), mend="name another folder")
        (folder / "secret.yaml").write_text(_CONCEALED, encoding="utf-8")
        for number, stop in enumerate(STOPS, 1):
            _visit(number, stop, folder, waiting=not yes and sys.stdin.isatty())
    print(
        "\nThat is the way: reach, record, diagnose. With only a table: nxt-twin map, then diagnose --mapping."
    )
    print(
        f"everything is in {out}"
        if out
        else "The folder is gone; --out FOLDER keeps it, with report/run.html."
    )


def _visit(number: int, stop: Stop, folder: Path, *, waiting: bool) -> None:
    """Tell of one stop, wait for Enter where somebody can press it, and run its command."""
    print(f"\n{number} of {len(STOPS)}. {stop.words}\n\n$ nxt-twin {shlex.join(stop.command)}", flush=True)
    if waiting:
        input("press Enter to run it ")
    command = [sys.executable, "-m", "nxt_twin", *stop.command]
    done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, check=False)  # noqa: S603 - this program
    if done.returncode != 0:
        raise NxtTwinError(
            f"ended with {done.returncode}", where=f"tour, step {number}", mend="see the line above"
        )
