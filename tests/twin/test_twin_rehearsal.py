"""Nothing is left to compile once a session's clock counts; told by a process of its own, where nothing ran before."""

import subprocess
import sys
from pathlib import Path

import pytest

WATCHED = """
from pathlib import Path
from numba import njit
from numba.core.dispatcher import Dispatcher
from twin_rig import EVERY_SENSOR, Rig, run, world_with
from twin_feed import nxt_motor
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import TwinOptions
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.rehearsal import rehearse

@njit
def never_met(x):
    return x + 1.0

load = {{"load_torque_nm": 0.05}}
rig = Rig(world_with(Path({folder!r}), effects={{"constant_load": load}}))
rehearse(dict.fromkeys("ab", nxt_motor()), adopting=True)
late, compile_ = [], Dispatcher.compile
def told(self, signature):
    late.append(self.py_func.__name__)
    return compile_(self, signature)
Dispatcher.compile = told
adopter = Adopter(AtOnce())
outcome = run(
    rig,
    13.0,
    ports=("a", "b"),
    sensors=EVERY_SENSOR,
    candidates=DEFAULT_CANDIDATES,
    period_s=0.02,
    adopter=adopter,
)
assert "adopted" in outcome.kinds(), outcome.kinds()
never_met(1.0)
print(",".join(sorted(set(late))))
"""


@pytest.mark.slow
def test_a_session_that_was_rehearsed_compiles_nothing(tmp_path):
    """A function that the rehearsal does not know shows that the watch sees what is compiled."""
    done = subprocess.run(
        [sys.executable, "-c", WATCHED.format(folder=str(tmp_path))],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "never_met"
