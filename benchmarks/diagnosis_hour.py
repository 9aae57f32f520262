"""A diagnosis of an hour of recordings, in a process of its own: the memory it takes at most, and the time."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.recording.case import read_case

_SEED = 160
_CONCEALED = ("gravity_load",)
_RECORDINGS_S = 1200.0  # each of three
_MOST_MB = 1000.0


def report() -> list[str]:
    """Peak memory and seconds of one diagnosis of three recordings of twenty minutes."""
    with tempfile.TemporaryDirectory() as folder:
        made = make_case(_SEED, effects=_CONCEALED, size="medium", duration_s=_RECORDINGS_S)
        case = write_case(made, Path(folder) / "cases", Path(folder) / "answers")
        told = subprocess.run(
            [sys.executable, "-m", "benchmarks.diagnosis_hour", str(case)],
            capture_output=True,
            text=True,
            check=True,
        )
    peak_mb, taken_s, named = told.stdout.split(maxsplit=2)
    met = "met" if float(peak_mb) <= _MOST_MB else "MISSED"
    return [
        f"3 recordings x {_RECORDINGS_S:g} s at 100 Hz, {', '.join(_CONCEALED)} concealed: {named.strip()}",
        f"peak memory of the process {float(peak_mb):.0f} MB (aim <= {_MOST_MB:g}: {met}), {float(taken_s):.0f} s",
    ]


def _diagnosed(folder: Path) -> str:
    began = time.perf_counter()
    found = diagnose(read_case(folder)).diagnosis
    taken_s = time.perf_counter() - began
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    named = ", ".join(effect.id for effect in found.effects) or "nothing"
    return f"{peak_mb} {taken_s} {found.verdict}, {named}"


if __name__ == "__main__":
    print(_diagnosed(Path(sys.argv[1])))
