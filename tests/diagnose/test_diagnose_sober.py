"""What a law gains once less unknown torque stands for it, on recordings of a simulator of the proof."""

from dataclasses import replace

from nxt_twin.blind.make import make_case, write_case
from nxt_twin.diagnose.engine import fit_as_it_stands, problem_for
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.judging.verdict import LIMITS
from nxt_twin.diagnose.where.noises import noises
from nxt_twin.diagnose.where.setting_in import SETTING_IN
from nxt_twin.diagnose.where.shapes import LAWS, SHAPES
from nxt_twin.diagnose.where.sober import ASKED, heard, sober_nats
from nxt_twin.diagnose.where.staged import staged
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import read_case


def gains(folder, effects, size=None):
    """The best gain of any law under a soberer noise, and under the estimated one."""
    made = make_case(720, effects=effects, size=size, duration_s=8.0, recordings=2)
    case = read_case(write_case(made, folder / "cases", folder / "answers"))
    problem, structure = problem_for(case), fit_as_it_stands(case)
    with Simulator(problem.plant.layout) as simulator:
        asked, _ = noises(simulator, problem, structure)
        linear = linearise(simulator, problem, replace(structure, noise=asked))
        scene = staged(simulator, problem, linear)
        own = max(heard(scene, linear, shape) for shape in ASKED)
        return sober_nats(simulator, problem, structure), own


def test_a_soberer_torque_shows_a_law_more_clearly_than_the_estimated_one(tmp_path):
    sober, own = gains(tmp_path, ("angle_speed_drag",), "medium")
    assert sober > max(own, LIMITS.sober)


def test_beside_a_motor_that_lacks_nothing_no_law_gains(tmp_path):
    sober, _ = gains(tmp_path, ())
    assert 0.0 <= sober < 0.5 * LIMITS.sober


def test_laws_leave_out_second_bodies_and_inertia_that_changes():
    left_out = {shape.rows.__name__ for shape in SHAPES if shape not in LAWS}
    assert left_out == {"_on_springs", "_behind_plays", "_by_rubbings", "_inertia_in_time"}
    assert {*LAWS, *SETTING_IN["high_speed"], *SETTING_IN["angle"]} == set(ASKED)
