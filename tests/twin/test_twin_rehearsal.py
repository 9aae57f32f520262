"""Nothing is left to compile once a session's clock counts; told by a process of its own, where nothing ran before."""

import subprocess
import sys
from pathlib import Path

import pytest

WATCHED = """
from pathlib import Path
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
    rig,
    {seconds},
    ports=("a", "b"),
    sensors=EVERY_SENSOR,
    candidates=DEFAULT_CANDIDATES,
    period_s=0.02,
    adopter=adopter,
)
assert "adopted" in outcome.kinds() or not {rehearsed}, outcome.kinds()
print(",".join(sorted(set(late))))
"""


@pytest.mark.parametrize(("rehearsed", "seconds"), [(True, 20.0), (False, 2.0)])
def test_a_session_that_was_rehearsed_compiles_nothing(tmp_path, rehearsed, seconds):
    """One that was not, however short, shows that the watch sees what is compiled."""
    program = WATCHED.format(folder=str(tmp_path), rehearsed=rehearsed, seconds=seconds)
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    late = set(done.stdout.strip().split(",")) - {""}
    assert late == (set() if rehearsed else late | {"put", "taken", "stirred"})
