"""What looks like a known effect of a robot and is none: wheels out of round, bent pictures, a camera's scale."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from diagnose_robot_cases import robot_case

from nxt_twin.blind.robot.world import make_world, nominal_robot
from nxt_twin.diagnose.robot.engine import diagnose_robot, robot_of
from nxt_twin.diagnose.robot.goes_on import what_goes_on
from nxt_twin.diagnose.robot.leftover import ShortErrors
from nxt_twin.diagnose.robot.runs import RobotRun, robot_runs
from nxt_twin.diagnose.robot.search import start_of, wheels_at
from nxt_twin.diagnose.robot.slip import SlipSpell, find_slip, gripping
from nxt_twin.diagnose.robot.slip_gain import brings_together
from nxt_twin.diagnose.robot.stack import stacked
from nxt_twin.physics.robot.drive import Geometry
from nxt_twin.physics.robot.odometry import PosePath
from nxt_twin.recording.case import case_of


def _ids(found):
    return {effect.id for effect in found.effects}


def test_a_wheel_that_is_not_round_is_known_to_no_effect_and_told_by_its_angle():
    found = diagnose_robot(robot_case(off_centre=0.06)).diagnosis
    assert found.verdict == "unexplained"
    assert any("angle of the left wheel" in note for note in found.notes)


@pytest.mark.parametrize(("scale", "told"), [(1.03, True), (1.0, False)])
def test_a_radius_and_a_track_off_by_one_factor_may_be_the_camera(scale, told):
    found = diagnose_robot(robot_case(scale=scale, radius_m=0.029 if scale == 1.0 else 0.028)).diagnosis
    assert _ids(found) == ({"wheel_radius", "wrong_track"} if told else {"wheel_radius"})
    assert any("camera whose scale" in note for note in found.notes) == told


def _bent(recording, share):
    """The recording where a lens shrinks the picture by so large a share 0.6 m from its middle, and less within."""
    x, y = (recording.columns[name] for name in ("pose_x_m", "pose_y_m"))
    middle = 0.1 + 0.1j
    ray = x + 1j * y - middle
    place = middle + ray * (1.0 - share * np.minimum(np.abs(ray) / 0.6, 1.2) ** 2)
    return replace(recording, columns={**recording.columns, "pose_x_m": place.real, "pose_y_m": place.imag})


@pytest.mark.parametrize(("seed", "share"), [(822, 0.1), (825, 0.05), (828, 0.05)])
def test_a_bent_picture_is_no_effect_of_a_robot_and_no_slip(seed, share):
    runs = tuple(_bent(one, share) for one in make_world([], seed).recordings)
    found = diagnose_robot(case_of(runs, nominal_robot(powered=False))).diagnosis
    assert found.verdict == "unexplained"
    assert "wheel_slip" not in _ids(found)
    assert any("The residual is largest" in note for note in found.notes)


def _seconds(rho, count=40, seed=1):
    """Errors of place of `count` seconds straight ahead in each of two runs; neighbours are alike by `rho`."""
    noise = np.random.default_rng(seed).standard_normal((2, 2, count))
    errors = noise.copy()
    for n in range(1, count):
        errors[..., n] = rho * errors[..., n - 1] + np.sqrt(1.0 - rho**2) * noise[..., n]
    scores = np.concatenate([errors.reshape(2, -1), np.zeros((1, 2 * count))])
    run, one, travel = np.repeat([0, 1], count), np.ones(2 * count), np.full(2 * count, 0.2)
    return ShortErrors(
        run, one, one, 5e-3 * scores, scores, travel, 0.0 * one, one, one, one, one,
        np.zeros((2, 2 * count)), np.zeros((2, 2, 2 * count)),
    )  # fmt: skip


def test_only_an_error_of_place_that_goes_on_from_second_to_second_is_told():
    assert [what_goes_on(_seconds(rho)) for rho in (0.0, -0.5)] == [[], []]
    (told,) = what_goes_on(_seconds(0.6))
    assert told.nats > 10.0
    assert told.size == pytest.approx(0.6, abs=0.2)


def test_an_error_goes_on_from_three_nats_on():
    found = [
        told
        for step in range(20, 60)
        for seed in (1, 2, 3)
        for told in what_goes_on(_seconds(0.01 * step, seed=seed))
    ]
    assert 3.0 < min(told.nats for told in found) < 3.1


def test_one_spell_of_slip_counts_once():
    world = make_world(["wheel_slip"], 807)
    case = case_of(world.recordings, world.content["plant"])
    drive = robot_of(case)
    runs = robot_runs(case.recordings, drive)
    given = start_of(drive.geometry, len(runs))
    spells = find_slip(runs, drive.geometry, wheels_at(stacked(runs), given))
    assert len(spells) > 5
    for one, other in combinations(spells, 2):
        if (one.recording, one.side) == (other.recording, other.side):
            assert one.end_s <= other.start_s or other.end_s <= one.start_s


def test_the_body_is_fitted_to_the_parts_between_spells_of_slip():
    time_s = np.arange(0.0, 20.0, 0.05)
    run = RobotRun("r1.csv", "r", time_s, time_s, time_s, PosePath(time_s, time_s, time_s))

    def spell(recording, start_s, end_s):
        return SlipSpell(0, recording, "left", start_s, end_s, 0.5, 0.1, 9.0)

    assert gripping(run, [spell("r2.csv", 5.0, 6.0)]) == [run]
    parts = gripping(run, [spell("r1.csv", 5.0, 6.0), spell("r1.csv (part 1 of 4)", 7.0, 8.0)])
    assert [(round(part.time_s[0], 1), round(part.time_s[-1], 1)) for part in parts] == [
        (0.0, 4.8),
        (8.2, 20.0),
    ]


@pytest.mark.slow
def test_slip_is_no_offset_of_the_centre_of_mass():
    world = make_world(["wheel_slip"], 711)
    found = diagnose_robot(case_of(world.recordings, world.content["plant"])).diagnosis
    assert _ids(found) == {"wheel_slip"}


@pytest.mark.parametrize(("share", "enough"), [(0.78, True), (0.82, False)])
def test_slip_has_to_bring_paths_nearer_their_poses(share, enough):
    time_s = np.arange(0.0, 20.0, 0.05)
    angle = 5.0 * time_s
    rolled = 0.028 * angle
    pose = PosePath(rolled, np.zeros_like(rolled), np.zeros_like(rolled))
    run = RobotRun("r1.csv", "r", time_s, angle, angle, pose)
    slipping, gripping = ([(angle * (1.0 + lost),) * 2] for lost in (0.1, 0.1 * share))
    assert brings_together([run], Geometry(0.028, 1.0, 0.12, 0.0, 0.0, 0.0), slipping, gripping) == enough
