"""Tyres that hold less than a motor at full power asks of them."""

import numpy as np
import pytest

from nxt_twin.diagnose.robot.hard_starts import hard_starts
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.search import search
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import axle_path

TRUE = Geometry(0.028, 1.0, 0.103)
STEP_S = 0.02
TIME_S = np.arange(0.0, 24.0, STEP_S)


def leg(way: int, grip_rad_s2: float):
    """Speeds of a wheel's rim and of its place on the floor: ahead for 0.8 s, rest, a turn for 0.5 s, rest."""
    phase = TIME_S % 2.0
    goal = np.where(phase < 0.8, 15.0, np.where((phase > 1.1) & (phase < 1.6), way * 8.0, 0.0))
    rim, floor = np.zeros(TIME_S.size), np.zeros(TIME_S.size)
    for n in range(1, TIME_S.size):
        rim[n] = rim[n - 1] + (goal[n] - rim[n - 1]) * (1.0 - np.exp(-STEP_S / 0.036))
        most = STEP_S * grip_rad_s2 if abs(rim[n]) > abs(floor[n - 1]) else np.inf
        floor[n] = floor[n - 1] + np.clip(rim[n] - floor[n - 1], -most, most)
    return rim, floor


def driven(truth: Geometry, *, grip_rad_s2: float = np.inf, lag_s: float = 0.0) -> RobotRun:
    wheels = [leg(way, grip_rad_s2) for way in (-1, 1)]
    turned = [np.radians(np.floor(np.degrees(STEP_S * np.cumsum(rim)))) for rim, _ in wheels]
    rolled = [STEP_S * np.cumsum(floor) for _, floor in wheels]
    late = [np.interp(TIME_S - lag_s, TIME_S, angle) for angle in rolled]
    return RobotRun("run.csv", "run", TIME_S, *turned, axle_path(truth, *late))


@pytest.mark.parametrize("ratio", [1.0, 27.0 / 28.0])
def test_wheels_are_told_where_tyres_slip_at_every_start(ratio):
    truth = Geometry(0.5 * 0.028 * (1.0 + ratio), ratio, 0.103)
    found = search((driven(truth, grip_rad_s2=70.0),), TRUE, lambda _: None)
    assert any(slip.lost is not None for slip in found.slips)
    fitted = found.final.state.as_geometry
    assert fitted.wheel_radius_ratio == pytest.approx(ratio, abs=0.006)
    assert fitted.mean_wheel_radius_m == pytest.approx(truth.mean_wheel_radius_m, rel=0.006)
    blamed = found.baseline.state.as_geometry
    assert abs(blamed.mean_wheel_radius_m / truth.mean_wheel_radius_m - 1.0) > 0.012


@pytest.mark.parametrize("grip_rad_s2", [50.0, 70.0, 100.0])
def test_slip_that_is_too_small_to_be_located_lends_no_effect_its_name(grip_rad_s2):
    found = search((driven(TRUE, grip_rad_s2=grip_rad_s2),), TRUE, lambda _: None)
    assert found.slips
    assert found.choice.named == ()


@pytest.mark.parametrize("lag_s", [0.0, 0.015, 0.04, 0.12])
def test_neither_grip_nor_a_late_pose_is_taken_for_slip(lag_s):
    assert hard_starts([driven(TRUE, lag_s=lag_s)], TRUE) == ()
    assert hard_starts([driven(Geometry(0.027, 0.97, 0.103), lag_s=lag_s)], TRUE) == ()
