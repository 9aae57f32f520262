"""Extra time of a diagnosis as a command of its own: starting, importing, and finding compiled code again."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.physics.kernel import CACHE_VARIABLE
from nxt_twin.recording.case import read_case

_SEED = 161
_DURATION_S = 30.0
_TIMES = 3
_MOST_S = 2.0


def report() -> list[str]:
    """Seconds of the command beside those of the same diagnosis in a process that has run one before."""
    with tempfile.TemporaryDirectory() as folder:
        made = make_case(_SEED, effects=(), size=None, duration_s=_DURATION_S)
        case = write_case(made, Path(folder) / "cases", Path(folder) / "answers")
        diagnose(read_case(case))
        cold_s, warm_s = zip(*((_command_s(case), _warm_s(case)) for _ in range(_TIMES)), strict=True)
        first_s = _command_s(case, Path(folder) / "empty")
    more_s = min(cold_s) - min(warm_s)
    said = "met" if more_s <= _MOST_S else "MISSED"
    return [
        f"3 recordings x {_DURATION_S:g} s at 100 Hz, nothing concealed; the quickest of {_TIMES} by turns",
        f"the command {min(cold_s):.1f} s, the same diagnosis warm {min(warm_s):.1f} s: "
        f"{more_s:.1f} s more (aim <= {_MOST_S:g}: {said})",
        f"the very first command on a machine, which compiles: {first_s:.1f} s",
    ]


def _command_s(case: Path, cache: Path | None = None) -> float:
    """Seconds of the whole command; with a `cache` of its own for all that is compiled."""
    own = {} if cache is None else {CACHE_VARIABLE: str(cache), "NUMBA_CACHE_DIR": str(cache)}
    began = time.perf_counter()
    command = [sys.executable, "-m", "nxt_twin", "diagnose", str(case), "--json", "-"]
    subprocess.run(command, check=True, capture_output=True, env={**os.environ, **own})
    return time.perf_counter() - began


def _warm_s(case: Path) -> float:
    began = time.perf_counter()
    diagnose(read_case(case))
    return time.perf_counter() - began
