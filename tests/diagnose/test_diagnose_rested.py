"""A friction that goes with the time at rest, as a shape that something missing may have."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.where.rested import RESTED, _by_rest

STEP_S = 0.01
HOLDING, SLIDING_ON = RESTED
UNIT = SimpleNamespace(speed=5.0)
RESTS_S = (0.1, 1.0)


@pytest.fixture(scope="module")
def course():
    """The plant rests for 0.1 s and for 1 s, driven forward, and turns forward for 0.5 s after each rest."""
    pace = np.concatenate([np.r_[np.zeros(round(rest_s / STEP_S)), np.full(50, 5.0)] for rest_s in RESTS_S])
    pace = np.concatenate([np.full(50, 5.0), pace])
    return SimpleNamespace(
        time_s=np.arange(pace.size) * STEP_S,
        pace=pace,
        position=np.cumsum(pace) * STEP_S,
        drive=np.ones(pace.size),
    )


def test_a_held_plant_is_held_by_the_rest_so_far(course):
    rows = HOLDING.rows(course, UNIT)
    resting = course.pace == 0.0
    assert not rows[:, ~resting].any()
    assert rows[:, resting].sum(axis=0) == pytest.approx(1.0)
    ends = np.flatnonzero(np.diff(resting.astype(int)) == -1)
    assert rows[1, ends[0]] == pytest.approx(1.0, abs=0.05)  # 0.1 s
    assert rows[3, ends[1]] == pytest.approx(1.0, abs=0.05)  # 1 s


def test_what_a_rest_has_left_fades_with_the_way_since_and_acts_against_the_motion(course):
    near, far = np.split(SLIDING_ON.rows(course, UNIT), 2)
    leaves = np.flatnonzero(np.diff((course.pace == 0.0).astype(int)) == -1)[1] + 1
    way = course.position[leaves + 4] - course.position[leaves - 1]
    assert near[:, leaves + 4].sum() == pytest.approx(np.exp(-np.degrees(way) / 2.0))
    assert far[:, leaves + 4].sum() == pytest.approx(np.exp(-np.degrees(way) / 8.0))
    course.drive[:] = -1.0
    assert HOLDING.rows(course, UNIT)[3, leaves - 1] < -0.9


def test_a_stick_slip_of_short_ways_goes_on_with_the_rest_before():
    pace = np.concatenate([np.zeros(100), np.full(1, 0.5), np.zeros(10)])
    course = SimpleNamespace(
        time_s=np.arange(pace.size) * STEP_S,
        pace=pace,
        position=np.cumsum(pace) * STEP_S,
        drive=np.ones(pace.size),
    )
    rested = HOLDING.rows(course, UNIT)[:, -1]
    assert rested[3] > 0.9


def driven(*pace):
    """A plant with these speeds, driven forward, one sample each."""
    speeds = np.array(pace)
    return SimpleNamespace(
        time_s=np.arange(speeds.size) * STEP_S,
        pace=speeds,
        position=np.cumsum(speeds) * STEP_S,
        drive=np.ones(speeds.size),
    )


@pytest.mark.parametrize(("share", "held"), [(0.0299, True), (0.0301, False)])
def test_a_plant_rests_below_three_percent_of_the_usual_speed(share, held):
    rows = HOLDING.rows(driven(5.0, *[share * 5.0] * 20), UNIT)
    assert rows[:, -1].any() == held


def test_the_friction_is_free_at_five_times_at_rest_a_factor_of_three_apart():
    rests_s = np.array([0.03, 0.1, 0.3, 1.0, 3.0])
    np.testing.assert_allclose(_by_rest(rests_s - 1e-3), np.eye(5), atol=1e-9)


def test_a_rest_is_forgotten_by_a_factor_of_e_each_eight_degrees():
    way = np.deg2rad(8.0) / STEP_S
    rows = HOLDING.rows(driven(*[0.0] * 301, way, 0.0), UNIT)[:, -1]
    forgotten_s = 3.0 * np.exp(-1.0)
    np.testing.assert_allclose(rows, _by_rest(np.array([forgotten_s]))[:, 0], atol=1e-6)
