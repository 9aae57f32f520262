"""Concealed robots: the true body against closed forms, worlds by seed, the score."""

import numpy as np
import pytest

from nxt_twin.blind.robot import bench
from nxt_twin.blind.robot.bench import (
    RobotOutcome,
    RobotPlan,
    case_of_world,
    plan_robots,
    robots_as_text,
    solve_robots,
)
from nxt_twin.blind.robot.truth.body import TrueRobot
from nxt_twin.blind.robot.truth.integrator import drive_robot
from nxt_twin.blind.robot.world import ROBOT_EFFECTS, make_world
from nxt_twin.diagnose.robot.engine import diagnose_robot
from nxt_twin.errors import DiagnosisError, NxtTwinError
from nxt_twin.fleet.workers.place import Processes

TIME_S = np.arange(0.0, 1.5, 0.05)


def states(robot, volts):
    none = np.zeros((TIME_S.size, 2))
    return drive_robot(np.array(robot.packed()), TIME_S, np.tile(volts, (TIME_S.size, 1)), none, none)


def test_without_friction_the_true_robot_runs_at_the_speed_of_its_back_emf():
    free = TrueRobot(dry_nm=(0.0, 0.0), wet_nm_s=(0.0, 0.0))
    found = states(free, (2.0, 2.0))[-1]
    assert found[5] == pytest.approx(2.0 / 0.49, rel=1e-3)
    assert found[3] == pytest.approx(0.028 * found[5], rel=5e-3)
    turning = states(free, (-2.0, 2.0))[-1]
    assert turning[4] == pytest.approx(2.0 * 0.028 * turning[7] / 0.12, rel=5e-3)


def test_an_equal_seed_makes_an_equal_world_and_another_another():
    one, again, other = (make_world(("wheel_slip",), seed) for seed in (3, 3, 4))
    assert one.content == again.content
    np.testing.assert_array_equal(
        one.recordings[0].columns["pose_x_m"], again.recordings[0].columns["pose_x_m"]
    )
    assert one.effects != other.effects


def test_the_plan_holds_what_was_asked_for_and_counts_its_seeds():
    plans = plan_robots(7000, singles=60, pairs=20, clean=30, unknown=10)
    assert [plan.seed for plan in plans] == list(range(7000, 7120))
    kinds = [plan.kind for plan in plans]
    assert [kinds.count(kind) for kind in ("single", "pair", "clean", "unknown")] == [60, 20, 30, 10]
    assert {plan.effects[0] for plan in plans if plan.kind == "single"} == set(ROBOT_EFFECTS)


def test_the_score_counts_exact_names_only():
    said = [
        RobotOutcome(RobotPlan("single", ("wrong_track",), 1), "explained", ("wrong_track",), (True,)),
        RobotOutcome(RobotPlan("single", ("wheel_slip",), 2), "explained", ("wheel_slip", "wrong_track"), ()),
        RobotOutcome(RobotPlan("clean", (), 3), "adequate", (), ()),
        RobotOutcome(RobotPlan("unknown", ("unknown_nap",), 4), "explained", ("pose_offset",), ()),
    ]
    text = robots_as_text(said)
    assert "exact                    0.500  ≥ 0.85  MISSED" in text
    assert "clean wrong              0.000  ≤ 0.03  met" in text
    assert "unknown misnamed         1.000  ≤ 0.15  MISSED" in text
    assert "seed 2, wheel_slip: explained, wheel_slip, wrong_track" in text


@pytest.mark.slow
def test_a_slope_and_a_wrong_track_are_named_together_with_their_sizes(tmp_path):
    plan = RobotPlan("pair", ("floor_slope", "wrong_track"), 7)
    (outcome,) = solve_robots([plan], tmp_path)
    assert outcome.exact
    assert sum(outcome.inside) >= 2
    (kept,) = solve_robots([plan], tmp_path, Processes(1))
    assert kept == outcome
    # Another range may conceal something else by this seed: its answer is another file.
    assert [path.name for path in tmp_path.iterdir()] == ["robot-7-floor_slope+wrong_track.json"]


def test_a_robot_that_cannot_be_diagnosed_is_named(tmp_path, monkeypatch):
    def refuse(_case):
        raise DiagnosisError("has no wheels")

    monkeypatch.setattr(bench, "diagnose_robot", refuse)
    with pytest.raises(NxtTwinError, match=r"robot-7: .*has no wheels"):
        next(solve_robots([RobotPlan("clean", (), 7)], tmp_path))


@pytest.mark.slow
def test_a_cable_that_pulls_is_known_to_no_effect_and_refused():
    said = diagnose_robot(case_of_world(make_world(("unknown_tether",), 0), 0)).diagnosis
    assert said.verdict == "unexplained"
    assert any("a force is missing" in note for note in said.notes)
