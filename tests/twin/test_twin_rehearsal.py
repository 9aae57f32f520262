"""Nothing is left to compile once a session's clock counts; told by a process of its own, where nothing ran before."""

import subprocess
import sys
from pathlib import Path

import pytest

WATCHED = """
from numba.core.dispatcher import Dispatcher
from twin_rig import EVERY_SENSOR, Rig, run, world_with
from twin_feed import nxt_motor
from nxt_twin.twin.adopt import Adopter, AtOnce
from nxt_twin.twin.brick_twin import TwinOptions
from nxt_twin.twin.candidates import DEFAULT_CANDIDATES
from nxt_twin.twin.rehearsal import rehearse

spring = {{"stiffness_nm_per_rad": 0.004, "rest_angle_deg": 0.0}}
rig = Rig(world_with(Path({folder!r}), effects={{"spring_load": spring}}))
if {rehearsed}:
    rehearse(dict.fromkeys("ab", nxt_motor()), adopting=True)
late, compile_ = [], Dispatcher.compile
def told(self, signature):
    late.append(self.py_func.__name__)
    return compile_(self, signature)
Dispatcher.compile = told
adopter = Adopter(AtOnce())
outcome = run(
    rig, 26.0, ports=("a", "b"), sensors=EVERY_SENSOR, candidates=DEFAULT_CANDIDATES, adopter=adopter
)
assert "adopted" in outcome.kinds(), outcome.kinds()
print(",".join(sorted(set(late))))
"""


@pytest.mark.parametrize("rehearsed", [True, False])
def test_a_session_that_was_rehearsed_compiles_nothing(tmp_path, rehearsed):
    program = "from pathlib import Path\n" + WATCHED.format(folder=str(tmp_path), rehearsed=rehearsed)
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    late = set(done.stdout.strip().split(",")) - {""}
    assert late == (set() if rehearsed else late | {"put", "taken", "stirred", "run_many"})
