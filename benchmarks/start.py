"""Processor time until the program answers: its import, its help, a brick, a prediction by the compiled model."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

_REPETITIONS = 5
_PROGRAM = (sys.executable, "-m", "nxt_twin")
_STARTS: dict[str, tuple[tuple[str, ...], float]] = {
    "import nxt_twin": ((sys.executable, "-c", "import nxt_twin"), 0.1),
    "nxt-twin --help": ((*_PROGRAM, "--help"), 0.4),
    "nxt-twin connect mock:": ((*_PROGRAM, "connect", "mock:"), 0.8),
    **{
        f"nxt-twin {verb} --help": ((*_PROGRAM, verb, "--help"), 0.8)
        for verb in ("diagnose", "live", "replay", "demo", "identify", "blind", "world")
    },
}
"""What is started, and the aim, s."""


def report() -> list[str]:
    """One line for each start: user and system time, the best of five."""
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run.csv"
        run.write_text("time_s,a_power_pct\n0,50\n0.5,50\n1,0\n", encoding="utf-8")
        predicts = (*_PROGRAM, "simulate", "nxt_motor", str(run))
        starts = {**_STARTS, "nxt-twin simulate": (predicts, 1.0)}
        return [
            f"{name:26} {min(_spent_s(command) for _ in range(_REPETITIONS)):.2f} s (aim: under {aim_s:g} s)"
            for name, (command, aim_s) in starts.items()
        ]


def _spent_s(command: Sequence[str]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
