"""A robot's missing physics, told from its wheels and a pose from outside."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from diagnose_robot_cases import PLANT, robot_case, square_run

from nxt_twin.diagnose.robot.engine import diagnose_robot, is_robot_case
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.simulate import expected_pose
from nxt_twin.diagnose.robot.slip import find_slip
from nxt_twin.diagnose.telling.to_json import to_json
from nxt_twin.errors import DiagnosisError, MissingDataError, PlantError
from nxt_twin.physics.robot.drive import Geometry, drive_from_config
from nxt_twin.physics.robot.odometry import axle_path, measured_path
from nxt_twin.recording.case import Case, read_case
from nxt_twin.recording.realdata import data_root
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.robot_path import RobotPath, write_path
from nxt_twin.recording.yaml_file import read_model
from nxt_twin.view.report import render_report


@cache
def found(**truth):
    return diagnose_robot(robot_case(**truth))


def ids(answer):
    return [effect.id for effect in answer.diagnosis.effects]


def test_wheels_that_turn_alike_go_straight_and_one_wheel_alone_goes_round_the_other():
    robot = Geometry(0.03, 1.0, 0.1)
    turns = np.linspace(0.0, 20.0, 7)
    path = axle_path(robot, turns, turns)
    np.testing.assert_allclose(path.x_m, 0.03 * turns)
    np.testing.assert_allclose(path.y_m, 0.0, atol=1e-15)
    round_left = axle_path(robot, np.zeros(7), turns)
    np.testing.assert_allclose(round_left.heading_rad, 0.03 * turns / 0.1)
    np.testing.assert_allclose(np.hypot(round_left.x_m, round_left.y_m - 0.05), 0.05)


def test_a_circle_closes_whatever_the_sampling():
    robot = Geometry(0.03, 1.25, 0.1)
    assert robot.right_wheel_radius_m == pytest.approx(1.25 * robot.left_wheel_radius_m)
    whole = 2.0 * np.pi * 0.1 / (robot.right_wheel_radius_m - robot.left_wheel_radius_m)
    for samples in (5, 50):
        turns = np.linspace(0.0, whole, samples)
        path = axle_path(robot, turns, turns)
        assert np.hypot(path.x_m[-1], path.y_m[-1]) < 1e-12


def test_markers_ahead_of_the_axle_swing_round_it_and_a_turned_frame_only_turns_headings():
    robot = Geometry(0.03, 1.0, 0.1, offset_forward_m=0.2, heading_offset_deg=10.0)
    turns = np.linspace(0.0, 0.1 / 0.06 * np.pi, 9)
    path = measured_path(robot, -turns, turns, (0.2, 0.0, np.radians(10.0)))
    np.testing.assert_allclose(np.hypot(path.x_m, path.y_m), 0.2)
    assert np.degrees(path.heading_rad[-1]) == pytest.approx(190.0)
    assert path.x_m[-1] == pytest.approx(-0.2)


def test_a_robot_as_its_model_says_lacks_nothing():
    answer = found()
    assert answer.diagnosis.verdict == "adequate"
    assert ids(answer) == []
    assert answer.diagnosis.fit.improved < 1.3 * answer.diagnosis.fit.floor


@pytest.mark.slow_variants
@pytest.mark.parametrize(
    ("truth", "effect", "parameter", "value"),
    [
        ({"radius_m": 0.0283}, "wheel_radius", "mean_wheel_radius_m", 0.0283),
        ({"ratio": 1.01}, "unequal_wheels", "wheel_radius_ratio", 1.01),
        ({"track_m": 0.125}, "wrong_track", "track_m", 0.125),
        ({"heading_deg": 1.5}, "pose_offset", "heading_offset_deg", 1.5),
        ({"lags": (0.08, 0.12)}, "clock_skew", "lag_s", 0.096),
        ({"slips": ((0, (4.0, 5.5, 0.4)), (2, (9.0, 10.5, 0.4)))}, "wheel_slip", "slip_ratio", 0.4),
    ],
)
def test_what_is_hidden_is_named_and_its_size_lies_within_the_interval(truth, effect, parameter, value):
    answer = found(**truth)
    assert answer.diagnosis.verdict == "explained"
    assert ids(answer) == [effect]
    estimate = answer.diagnosis.effects[0].params[parameter]
    low, high = estimate.interval_95
    assert low - 0.5 * estimate.std <= value <= high + 0.5 * estimate.std


def test_a_floor_that_pushes_one_way_is_known_to_no_effect_and_refused():
    said = found(drift=0.04).diagnosis
    assert said.verdict == "unexplained"
    assert said.next_experiment is not None
    assert any("goes with the direction" in note for note in said.notes)


def stretched(run, *, backwards):
    """The run in a picture that is 5 % too wide; backwards, the robot drives it with its tail ahead."""
    columns = {**run.columns, "pose_x_m": 1.05 * run.columns["pose_x_m"]}
    if backwards:
        left, right = columns["b_tacho_deg"], columns["c_tacho_deg"]
        columns |= {"b_tacho_deg": -right, "c_tacho_deg": -left}
        columns["pose_heading_deg"] = columns["pose_heading_deg"] + 180.0
    return Recording(run.name, columns)


def test_a_picture_that_is_too_wide_is_known_to_no_effect_where_the_robot_drives_both_ways():
    case = robot_case(runs=6)
    runs = tuple(stretched(run, backwards=n >= 3) for n, run in enumerate(case.recordings))
    said = diagnose_robot(Case("robot", Path(), PLANT, runs, (), None)).diagnosis
    assert said.verdict == "unexplained"
    assert any("goes with the axis of travel" in note for note in said.notes)


def test_the_json_is_that_of_the_contract_and_the_model_predicts_unseen_runs():
    case = robot_case(runs=6, hold_out=2, track_m=0.125)
    answer = diagnose_robot(case)
    said = json.loads(to_json(answer.diagnosis))
    assert said["mismatch"]["equation"] == "torque_balance"
    assert said["effects"][0]["params"]["track_m"]["unit"] == "m"
    assert said["refit"]["track_m"]["from"] == 0.12
    assert [one["recording"] for one in said["held_out"]] == ["r5.csv", "r6.csv"]
    assert said["fit"]["unit"] == "mm"
    horizons = said["fit"]["horizons"]
    assert [one["seconds"] is None for one in horizons] == [False, False, True]
    assert all(one["improved"] < one["given"] for one in horizons)
    config = answer.model.to_config()
    assert drive_from_config(config).geometry.track_m == pytest.approx(0.125, abs=4e-4)
    after, before = (expected_pose(one, case.holdout[0], None) for one in (config, PLANT))
    assert after[0].rmse < 0.3 * before[0].rmse


def test_turning_one_way_only_leaves_open_whether_track_or_ratio_is_off():
    circle = np.arange(0.0, 40.0, 0.05)
    heading = 0.2 / 0.6 * circle
    columns = {
        "time_s": circle,
        "b_tacho_deg": np.degrees(0.179 * circle / 0.028),
        "c_tacho_deg": np.degrees(0.221 * circle / 0.028),
        "pose_x_m": 0.6 * np.sin(heading),
        "pose_y_m": 0.6 * (1.0 - np.cos(heading)),
        "pose_heading_deg": np.degrees(heading),
    }
    noise = np.random.default_rng(1).standard_normal((3, circle.size))
    for name, one, size in zip(
        ("pose_x_m", "pose_y_m", "pose_heading_deg"), noise, (5e-4, 5e-4, 0.2), strict=True
    ):
        columns[name] = columns[name] + size * one
    said = diagnose_robot(
        Case("circle", robot_case().folder, PLANT, (Recording("r.csv", columns),), (), None)
    ).diagnosis
    assert any("only one way" in note for note in said.notes)
    assert said.next_experiment is not None
    assert "to the left and five times to the right" in said.next_experiment.input
    assert len(said.effects) == 1
    either = {said.effects[0].id, *(other.id for other in said.effects[0].confusable_with)}
    assert {"wrong_track", "unequal_wheels"} <= either


def test_turning_on_the_spot_tells_a_radius_from_a_track_by_no_noise():
    time_s = np.arange(0.0, 40.0, 0.05)
    angle = 12.0 * np.sin(0.8 * time_s)
    heading = 2.0 * 0.028 * angle / 0.125
    aside = 4e-4 * np.sin(0.4 * time_s)  # tyres creep a little, always alike: this is no travel
    columns = {
        "time_s": time_s,
        "b_tacho_deg": np.floor(np.degrees(-angle)),
        "c_tacho_deg": np.floor(np.degrees(angle) + 3.0 * np.sin(0.8 * time_s)),
        "pose_x_m": aside,
        "pose_y_m": -aside,
        "pose_heading_deg": np.degrees(heading),
    }
    said = diagnose_robot(
        Case("spins", robot_case().folder, PLANT, (Recording("r.csv", columns),), (), None)
    ).diagnosis
    named = {effect.id: effect for effect in said.effects}
    assert not {"wheel_radius", "unequal_wheels"} & set(named)
    assert named["wrong_track"].params["track_m"].value == pytest.approx(0.125, rel=0.01)
    assert [other.id for other in named["wrong_track"].confusable_with] == ["wheel_radius"]
    assert list(said.refit) == ["track_m"]
    assert any("only the ratio of wheel radius to track" in note for note in said.notes)
    assert said.next_experiment is not None


def test_the_report_draws_the_path_on_the_floor():
    page = render_report(found(track_m=0.125).diagnosis)
    assert "path on the floor" in page
    assert "model as given" in page
    assert "begun at its first measured pose" in page


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"left": "d"}, "'d' is no port"),
        ({"right": "b"}, "both wheels are on port b"),
        ({"track_m": 0.0}, "not positive"),
        ({"trackm": 0.1}, "did you mean 'track_m'"),
        ({"effects": {"wrong_track": {"track": 0.1}}}, "unknown key 'track'"),
    ],
)
def test_a_wrong_key_of_the_robot_is_named(change, says):
    with pytest.raises(PlantError, match=says):
        drive_from_config({**PLANT, **change})


def test_without_a_pose_from_outside_nothing_is_concluded():
    run = square_run("r1.csv", 1)
    bare = Recording("r1.csv", {name: run.columns[name] for name in ("time_s", "b_tacho_deg", "c_tacho_deg")})
    case = Case("bare", robot_case().folder, PLANT, (bare,), (), None)
    assert is_robot_case(case)
    with pytest.raises(DiagnosisError, match="without a pose from outside"):
        diagnose_robot(case)


@pytest.mark.real_data
def test_the_real_robots_markers_and_clock_are_named_and_unseen_runs_predicted():
    try:
        folder = data_root() / "robot-optiodom"
    except MissingDataError as missing:
        pytest.skip(str(missing))
    if not folder.is_dir():
        pytest.skip("the robot's recordings are not here")
    said = diagnose_robot(read_case(folder)).diagnosis
    assert {"pose_offset", "clock_skew"} <= {effect.id for effect in said.effects}
    assert "unequal_wheels" not in {effect.id for effect in said.effects}
    named = {effect.id: effect.params for effect in said.effects}
    assert named["pose_offset"]["heading_offset_deg"].value == pytest.approx(-0.39, abs=0.1)
    low, high = named["wrong_track"]["track_m"].interval_95
    assert low < 0.2003 < 0.2028 < high
    without = {"held_out/square_231220200029_02.csv", "held_out/free_030120210001_02.csv"}
    kept = [run for run in said.held_out if run.recording not in without]
    whole = np.sqrt(np.mean(np.concatenate([run.improved**2 for run in kept])))
    assert whole < 18.0
    assert said.fit.horizons[-1].given == pytest.approx(58.7, abs=0.1)
    assert said.fit.improved < 27.3


@pytest.mark.parametrize(
    ("scrub", "lag_s", "back_s"), [(0.05, 0.0, 11.0), (0.05, 0.0, 9.5), (0.02, 0.01, 9.5)]
)
def test_tyres_that_scrub_in_a_long_spin_are_no_spell_of_slip(scrub, lag_s, back_s):
    robot = Geometry(0.028, 1.0, 0.103)
    time_s = np.arange(0.0, 26.0, 0.02)
    ahead = np.where((time_s < 7.5) | (time_s > 11.5), 8.0, 0.0)
    turning = np.where((time_s > 8.0) & (time_s < 11.0), np.where(time_s < back_s, 8.0, -8.0), 0.0)
    ahead, turning = (np.convolve(rate, np.full(7, 1.0 / 7.0), "same") for rate in (ahead, turning))
    counted = [np.radians(np.floor(np.degrees(0.02 * np.cumsum(ahead + way * turning)))) for way in (-1, 1)]
    rolled = [0.02 * np.cumsum(ahead + way * (1.0 - scrub) * turning) for way in (-1, 1)]
    late = [np.interp(time_s - lag_s, time_s, angle) for angle in rolled]
    run = RobotRun("run.csv", "run", time_s, *counted, axle_path(robot, *late))
    assert all(spell.ratio < 0.1 for spell in find_slip([run], robot, [tuple(counted)]))


def test_an_effect_that_moves_the_path_by_less_than_matters_gets_no_name():
    case = robot_case(radius_m=0.02805)
    named, tolerated = diagnose_robot(case), diagnose_robot(case, tolerance_m=0.02)
    assert ids(named) == ["wheel_radius"]
    assert tolerated.diagnosis.verdict == "adequate"
    assert ids(tolerated) == []
    assert "less than the tolerance of 20 mm" in tolerated.diagnosis.sentence
    assert tolerated.diagnosis.tolerance.unit == "mm"
    assert ids(diagnose_robot(robot_case(track_m=0.125), tolerance_m=0.02)) == ["wrong_track"]


def test_the_next_experiment_is_a_path_to_drive(tmp_path):
    experiment = found(drift=0.04).diagnosis.next_experiment
    write_path(experiment.path, tmp_path / "path.yaml")
    path = read_model(tmp_path / "path.yaml", RobotPath, DiagnosisError)
    turned = [leg.turn_deg for leg in path.legs if leg.turn_deg]
    assert max(turned) > 0.0 > min(turned)
    assert path.why == experiment.why


def _with_columns(case, change):
    changed = tuple(
        replace(each, columns={**each.columns, **change(each.columns)}) for each in case.recordings
    )
    return replace(case, recordings=changed)


def test_wheels_of_another_unit_get_no_name():
    case = _with_columns(robot_case(), lambda columns: {
        name: 0.2 * columns[name] for name in ("b_tacho_deg", "c_tacho_deg")
    })  # fmt: skip
    answer = diagnose_robot(case)
    assert answer.diagnosis.verdict == "unexplained"
    assert ids(answer) == []
    assert "Check units, gains and signs" in answer.diagnosis.notes[0]
    assert answer.model.geometry == drive_from_config(PLANT).geometry


@pytest.mark.parametrize(
    "change",
    [
        lambda columns: {"b_tacho_deg": columns["c_tacho_deg"], "c_tacho_deg": columns["b_tacho_deg"]},
        lambda columns: {"pose_heading_deg": -columns["pose_heading_deg"], "pose_y_m": -columns["pose_y_m"]},
    ],
)
def test_a_pose_that_turns_against_its_wheels_is_refused(change):
    with pytest.raises(DiagnosisError, match=r"turns the other way round than its wheels .exchange `left`"):
        diagnose_robot(_with_columns(robot_case(), change))
