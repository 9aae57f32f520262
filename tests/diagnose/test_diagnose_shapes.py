"""What something missing may look like, and how the readings answer to it."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_motors import clean_case, settled

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.where.course import course_of
from nxt_twin.diagnose.where.response import response
from nxt_twin.diagnose.where.second_body import behind_play, by_rubbing, on_a_spring
from nxt_twin.diagnose.where.shapes import SHAPES, hats, yardstick
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.simulate import Simulator

TIME_S = np.arange(0.0, 4.0, 0.01)
POSITION = np.sin(3.0 * TIME_S)
SPEED = 3.0 * np.cos(3.0 * TIME_S)
ACCELERATION = -9.0 * POSITION


@pytest.fixture(scope="module")
def baseline():
    case = clean_case(41)
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, structure = settled(simulator, case)
        yield simulator, linearise(simulator, problem, structure)


def test_hats_share_every_value_among_them():
    values = np.linspace(-5.0, 5.0, 101)
    found = hats(values, [-2.0, 0.0, 1.0])
    assert found.sum(axis=0) == pytest.approx(1.0)
    assert found[1, values == 0.0] == pytest.approx(1.0)
    assert found[0, 0] == pytest.approx(1.0)
    assert found[2, -1] == pytest.approx(1.0)


def test_a_stiff_spring_makes_its_body_one_with_the_plant():
    spring, damper = on_a_spring(TIME_S, POSITION, 15.0, 0.3)
    pull = spring + 2.0 * 0.3 * damper
    late = TIME_S > 1.0
    assert np.corrcoef(pull[late], -ACCELERATION[late])[0, 1] > 0.99
    assert np.std(pull[late]) == pytest.approx(np.std(ACCELERATION[late]), rel=0.1)


def test_a_body_behind_play_takes_its_momentum_from_blows():
    blows = behind_play(TIME_S, POSITION, SPEED, 0.2, 0.0, 0.0)
    momentum = -np.cumsum(blows[1:] * np.diff(TIME_S))
    assert np.mean(blows != 0.0) < 0.7  # between them it runs freely
    assert np.abs(momentum).max() == pytest.approx(np.abs(SPEED).max(), rel=0.02)


@pytest.mark.parametrize(("grip", "share"), [(100.0, 1.0), (2.0, None)])
def test_a_rubbed_body_follows_no_harder_than_the_grip_allows(grip, share):
    pull = by_rubbing(TIME_S, SPEED, grip)
    assert np.abs(pull).max() <= grip * 1.001
    if share:
        late = TIME_S > 1.0
        assert pull[late] == pytest.approx(-share * ACCELERATION[late], abs=0.15)


def test_readings_answer_to_a_missing_torque_as_a_run_without_it_tells(baseline):
    simulator, linear = baseline
    plant, noise, job = linear.structure.plant, linear.structure.noise, linear.jobs[0]
    torque = 2e-3
    loaded = plant.with_effect("constant_load", {"load": torque})
    moved = simulator.trace(loaded, job)["predicted"] - simulator.trace(plant, job)["predicted"]
    rows = np.full((1, moved.size), torque / plant.values[Slot(BASE_OWNER, "inertia")])
    told = response(job, course_of(simulator, plant, job, 0.0), noise, rows, "torque")[0]
    assert np.corrcoef(told, moved)[0, 1] > 0.9
    assert np.std(told) == pytest.approx(np.std(moved), rel=0.2)


def test_no_shape_knows_the_reading_of_its_own_stamp(baseline):
    simulator, linear = baseline
    plant, job = linear.structure.plant, linear.jobs[0]
    at = 400
    measured = job.signals.measured.copy()
    measured[at] += np.deg2rad(3.0)
    other = replace(job, signals=replace(job.signals, measured=measured))
    plain, moved = (course_of(simulator, plant, one, 0.0) for one in (job, other))
    unit = yardstick([plain])
    for shape in SHAPES:
        one, two = shape.rows(plain, unit), shape.rows(moved, unit)
        assert two[:, : at + 1] == pytest.approx(one[:, : at + 1])
    assert not np.allclose(plain.speed[at + 1 :], moved.speed[at + 1 :])
