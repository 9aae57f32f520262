"""What a scene does to a robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from nxt_twin.world.arena import Arena, open_arena
from nxt_twin.world.load import load_setting
from nxt_twin.world.program import let_pass


@pytest.fixture
def placed(tmp_path: Path):
    def place(robot: str = "castor_bot", **scene) -> Arena:
        path = tmp_path / "world.yaml"
        path.write_text(yaml.safe_dump({"robot": robot, "scene": scene}))
        return open_arena(load_setting(path))

    return place


def drive(arena: Arena, power: int, seconds: float) -> None:
    for port in (1, 2):
        arena.body.set_motor(port, power, brake=True)
    let_pass(arena, seconds)


def slipped_m(arena: Arena) -> float:
    return 0.028 * arena.body.motors.angles_rad()[1] - float(arena.robot_pose().at_m[0])


def test_wheels_slip_on_a_carpet_that_hardly_holds(placed):
    ice = {"patch_mm": [[-500, -500], [2000, 500]], "friction": 0.05}
    bare, icy = placed(), placed(carpets=[ice])
    for arena in (bare, icy):
        let_pass(arena, 0.1)
        drive(arena, 80, 0.6)
    assert slipped_m(bare) < 0.02
    assert slipped_m(icy) > 0.05


def test_a_robot_rolls_down_a_slope_that_its_motors_do_not_hold(placed):
    level, steep = placed(), placed(slope_deg=12.0, uphill_deg=0.0)
    for arena in (level, steep):
        let_pass(arena, 1.0)
    assert abs(level.robot_pose().at_m[0]) < 1e-4
    assert steep.robot_pose().at_m[0] < -0.02
    assert abs(steep.robot_pose().at_m[1]) < 1e-3


def test_a_robot_starts_where_the_scene_says(placed):
    pose = placed(start={"at_mm": [300, -200], "heading_deg": 90}).robot_pose()
    assert pose.at_m[:2] == pytest.approx([0.3, -0.2], abs=1e-9)
    assert pose.heading_deg == pytest.approx(90.0)


def test_a_robot_pushes_what_has_a_mass_and_stops_at_what_has_none(placed):
    box = {"box_mm": [80, 200, 80], "at_mm": [150, 0, 40]}
    loose, fixed = placed(things={"box": {**box, "mass_g": 100}}), placed(things={"box": box})
    for arena in (loose, fixed):
        drive(arena, 40, 1.5)
    assert loose.thing_pose("box").at_m[0] > 0.25
    assert fixed.thing_pose("box").at_m[0] == pytest.approx(0.15)
    assert fixed.robot_pose().at_m[0] < 0.11
    assert np.isfinite(fixed.robot_pose().at_m).all()


def test_a_robot_that_is_like_another_has_all_but_what_it_says_itself(tmp_path):
    path = tmp_path / "world.yaml"
    path.write_text("robot: {like: castor_bot, wheels: {right: {radius_mm: 27.5}}}")
    wheels = load_setting(path).robot.wheels
    assert (wheels["left"].radius_mm, wheels["right"].radius_mm) == (28.0, 27.5)
    assert wheels["right"].at_mm == (0.0, -51.5, 28.0)


def test_a_balance_says_of_a_castor_bot_what_it_said_of_the_real_one(placed):
    robot = placed().setting.robot.assembly(dict.fromkeys("abc", 0.0))
    assert 1e3 * robot.mass_kg == pytest.approx(600.0, abs=5.0)
    on_wheels = 1.0 + robot.centre_m[0] / 0.11  # by the lever between axle and castor
    assert on_wheels == pytest.approx(388.0 / 600.0, abs=0.01)
