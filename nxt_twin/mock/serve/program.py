"""Run somebody's program in this process, its USB being a bus of mock bricks, without a change in it.

Whatever library the program uses has to reach USB through pyusb, as nxt-python does.
"""

from __future__ import annotations

import runpy
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, Literal
from unittest.mock import patch

import usb.backend.libusb1

from nxt_twin.brick.clock import Clock
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import PROFILES
from nxt_twin.mock.serve.usb import MockUsbBackend, ServedUsbDevice
from nxt_twin.mock.start import Bodies, BodyChange, bare_body, switch_on

_SHOWN: Final = 300

ScriptEnding = Literal["done", "failed"]


def run_script(script: Path, arguments: Sequence[str], bus: MockUsbBackend) -> tuple[ScriptEnding, str]:
    """Run a Python file as if from the command line until it ends.

    Args:
        script: the file.
        arguments: its command line.
        bus: what it finds on USB.

    Returns:
        How it ended, and what was wrong in one line; empty if nothing was.
    """
    with patch.object(usb.backend.libusb1, "get_backend", lambda *_, **__: bus), _as_main(script, arguments):
        try:
            runpy.run_path(str(script), run_name="__main__")
        except SystemExit as leaving:
            wrong = leaving.code not in (None, 0)
            return ("failed", f"{script}: left with status {leaving.code}") if wrong else ("done", "")
        except Exception as error:
            return "failed", _told(script, error)
    return "done", ""


def serve_script(
    script: Path,
    arguments: Sequence[str],
    clock: Clock,
    *,
    world: Path | None = None,
    seed: int = 0,
    profile: str = "usb",
    change: BodyChange = lambda _: None,
    bodies: Bodies = bare_body,
) -> tuple[ScriptEnding, str]:
    """Run a program beside a mock brick on its USB, by a clock that the brick follows.

    Args:
        script: the program.
        arguments: its command line.
        clock: the machine's.
        world: a world file; without it the brick is as LEGO ships it.
        seed: of noise and jitter.
        profile: delays of the link, by name (`nxt_twin.mock.serve.profile.PROFILES`).
        change: done to the brick's body before it is switched on.
        bodies: makes that body.

    Returns:
        As `run_script`.

    Raises:
        WorldError: the world file is none.
        PlantError: a motor's plant in it is none.
    """
    host = Host(switch_on(world, seed, change=change, bodies=bodies), clock)
    device = ServedUsbDevice(host, profile=PROFILES[profile], seed=seed)
    return run_script(script, arguments, MockUsbBackend([device]))


def _told(script: Path, error: Exception) -> str:
    """A program's error in one line, with the line of its own at which it came up."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if Path(f.filename) == script]
    place = f"{script}, line {frames[-1].lineno}" if frames else str(script)
    missing = isinstance(error, ModuleNotFoundError) and (error.name or "").partition(".")[0] == "nxt"
    mend = " (pip install nxt-python)" if missing else ""
    return " ".join(f"{place}: {type(error).__name__}: {error}{mend}".split())[:_SHOWN]


@contextmanager
def _as_main(script: Path, arguments: Sequence[str]) -> Iterator[None]:
    kept: tuple[Any, Any] = (sys.argv, sys.path)
    sys.argv, sys.path = [str(script), *arguments], [str(script.parent), *sys.path]
    try:
        yield
    finally:
        sys.argv, sys.path = kept
