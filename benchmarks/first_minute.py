"""How long the README's first screen takes a newcomer, from each of its three beginnings to the first answer.

python -m benchmarks first_minute
python -m benchmarks.first_minute     # each line as soon as it is measured

Each way runs in an empty folder and with empty caches, so it includes what is compiled once. The brick is a mock on a
pseudo-terminal, in real time; its URL stands for `usb:`. The commands are those that README.md prints.
"""

from __future__ import annotations

import os
import resource
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Final

import numpy as np

import nxt_twin as nt

_README: Final = Path(__file__).parents[1] / "README.md"
_WAYS: Final = (
    ("with a brick", "With a brick"),
    ("without one", "Without a brick"),
    ("a table", "With only"),
)
"""What each way is called here, and how the README's line above its commands begins."""
_PROGRAM: Final = (sys.executable, "-m", "nxt_twin")
_PTY: Final = "brick"
_LOAD_NM: Final = 0.04
_LEVELS_PCT: Final = (60, -40, 90, 20, -80, 50, -20, 100, -60, 30)


def report() -> Iterator[str]:
    """One line a way: time by the clock, processor time, and the answer."""
    yield f"load average {os.getloadavg()[0]:.1f}; aim: 300 s by the clock"
    for name, beginning in _WAYS:
        with tempfile.TemporaryDirectory(prefix="nxt-twin-first-") as folder:
            yield f"{name}: {_way(Path(folder), _commands(beginning))}"


def _commands(beginning: str) -> list[str]:
    """The commands that the README prints below the line that begins so."""
    text = _README.read_text(encoding="utf-8")
    block = text[text.index(f"\n{beginning}") :].split("\n\n")[1]
    return [line.strip() for line in block.splitlines()]


def _way(folder: Path, commands: list[str]) -> str:
    _write_log(folder / "log.csv")
    caches = folder / "caches"
    environment = {**os.environ, "NXT_TWIN_CACHE": str(caches), "NUMBA_CACHE_DIR": str(caches)}
    with ExitStack() as ending:
        if any("usb:" in command for command in commands):
            ending.enter_context(_served(folder))
        began_s, before_s, answer = time.monotonic(), _spent_s(), ""
        for command in commands:
            said = _run(command.replace("usb:", f"serial:{_PTY}"), folder, environment)
            if " diagnose " in command:
                answer = " ".join(said.split("\n")[:2]).strip()
        wall_s, processor_s = time.monotonic() - began_s, _spent_s() - before_s
    return f"{wall_s:.0f} s by the clock, {processor_s:.1f} s of processor time; {answer}"


def _run(command: str, folder: Path, environment: Mapping[str, str]) -> str:
    """What a command of the README says; `--yes` stands for the newcomer's answer that motors may turn."""
    words = [*_PROGRAM, *shlex.split(command, comments=True)[1:]]
    words += ["--yes"] if words[len(_PROGRAM)] == "record" else []
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


@contextmanager
def _served(folder: Path) -> Iterator[None]:
    """A mock brick on a pseudo-terminal of this folder."""
    command = [*_PROGRAM, "mock", "--pty", _PTY]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as mock:
        try:
            assert mock.stdout is not None
            mock.stdout.readline()  # it says where the brick is once it is there
            yield
        finally:
            mock.terminate()


def _write_log(path: Path) -> None:
    """A stranger's table of a loaded motor: milliseconds, duty and whole degrees."""
    time_s = np.arange(0.0, 10.0, 0.02)
    power = np.array([float(_LEVELS_PCT[int(stamp)]) for stamp in time_s])
    motor = nt.load_plant("nxt_motor").adding("constant_load", load_torque_nm=_LOAD_NM)
    run = nt.simulate(motor, nt.Recording("log", {"time_s": time_s, "a_power_pct": power}))
    cells = zip(time_s, power, run.columns["a_tacho_deg"], strict=True)
    rows = [f"{1000 * stamp:.0f};{duty:.0f};{angle:.0f}" for stamp, duty, angle in cells]
    path.write_text("\n".join(["ms;pwm;degrees", *rows, ""]), encoding="utf-8")


def _spent_s() -> float:
    """Processor time of all commands that have ended."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


if __name__ == "__main__":
    for line in report():
        print(line, flush=True)
