"""A friction that goes with the time at rest, as a shape that something missing may have."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.where.rested import RESTED

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
