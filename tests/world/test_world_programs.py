"""What programs do, judged from the world, never from the program's word."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from world_runs import run

from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.recording.robot_path import squares_and_lines, write_path
from nxt_twin.world.arena import open_arena
from nxt_twin.world.ghost import ghost_of
from nxt_twin.world.load import load_setting
from nxt_twin.world.program import let_pass, run_program
from nxt_twin.world.trace import Trace


def test_the_first_program_of_the_page_does_what_the_page_says(tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "world.md").read_text()
    script = tmp_path / "square.py"
    script.write_text(page.split("```python\n")[1].split("```")[0])
    arena = open_arena(load_setting("playground"))
    course = Trace(arena)
    run_program(arena, script, (), limit_s=60.0)
    assert course.column("heading_deg")[-1] == pytest.approx(-341.0, abs=1.0)
    assert np.linalg.norm(course.places_m[-1]) == pytest.approx(0.17, abs=0.01)
    x_m, y_m, _ = ghost_of(course, drive_from_config(load_plant_config("castor_bot")))[-1]
    assert np.linalg.norm(course.places_m[-1] - (x_m, y_m)) < 2e-3


def test_a_castor_bot_drives_a_square():
    driven = run("playground", "drive_square.py")
    corners = np.array([(0.25, 0.0), (0.25, 0.25), (0.0, 0.25), (0.0, 0.0)])
    nearest = np.linalg.norm(driven.trace.places_m[:, None] - corners, axis=2).min(axis=0)
    assert nearest.max() < 0.05
    assert np.linalg.norm(driven.trace.places_m[-1]) < 0.05
    assert abs(driven.trace.column("heading_deg")[-1] - 360.0) < 8.0
    assert abs(driven.trace.column("z_m")).max() < 1e-3


@pytest.mark.slow
def test_a_castor_bot_drives_a_written_path(tmp_path):
    write_path(
        squares_and_lines("test", side_m=0.2, laps=1, straight_m=0.3, rest_s=0.3), tmp_path / "path.yaml"
    )
    driven = run("playground", "drive_path.py", str(tmp_path / "path.yaml"))
    heading = driven.trace.column("heading_deg")
    assert heading.max() > 345.0
    assert heading[-1] == pytest.approx(90.0, abs=12.0)
    assert np.linalg.norm(driven.trace.places_m[-1]) < 0.05
    assert driven.trace.path_m > 2 * 4 * 0.2 + 4 * 0.3


def test_a_robot_follows_a_line_all_the_way_round():
    followed = run("line", "follow_line.py")
    line_m = 1e-3 * np.array(followed.arena.setting.scene.floor.prints[0].line_mm)
    along = np.linspace(line_m[:-1], line_m[1:], 30).reshape(-1, 2)
    away = np.linalg.norm(followed.trace.places_m[:, None] - along, axis=2)
    assert away.min(axis=1).max() < 0.06
    assert away.min(axis=0).max() < 0.06
    assert 330.0 < followed.trace.column("heading_deg")[-1] < 520.0


def test_a_robot_stops_before_a_wall():
    stopped = run("wall", "stop_before_wall.py")
    gap_m = 1.2 - (stopped.trace.places_m[-1, 0] + 0.072)  # the bumper is 72 mm ahead of the axle
    assert 0.08 < gap_m < 0.2
    assert np.ptp(stopped.trace.places_m[-5:, 0]) < 3e-3


def test_a_robot_wanders_in_a_pen_and_touches_nothing():
    wandered = run("pen", "avoid_walls.py")
    assert wandered.trace.path_m > 1.5
    assert np.abs(wandered.trace.places_m).max() < 0.6 - 0.072
    engine, robot = wandered.arena.engine, wandered.arena.robot
    assert not any(
        engine._p.getContactPoints(robot, wall, physicsClientId=engine._id) for wall in _walls(wandered)
    )


def test_a_robot_finds_the_middle_of_a_gradient():
    read = run("gradient", "read_gradient.py")
    sensor_m = read.trace.places_m[-1, 0] + 0.07
    assert abs(sensor_m - 0.5 * 0.297) < 0.02


def test_an_arm_is_lifted_held_and_let_down():
    lifted = run("arm", "lift_arm.py")
    angle = lifted.trace.column("a_deg")
    held = angle[(lifted.trace.column("time_s") > 3.0) & (lifted.trace.column("time_s") < 3.5)]
    assert np.abs(held - 60.0).max() < 2.0
    assert angle[-1] < 5.0


def test_a_sorter_sorts_six_balls_by_their_colour():
    sorted_balls = run("sorter", "sort_balls.py")
    places = {name: sorted_balls.arena.thing_pose(name).at_m for name in sorted_balls.arena.things}
    balls = {name: place for name, place in places.items() if name.startswith(("red", "blue"))}
    assert len(balls) == 6
    for name, (_, y, z) in balls.items():
        assert z < 0.03
        assert (y > 0.1) if name.startswith("red") else (y < -0.1), name


def test_a_sumo_robot_pushes_the_other_out_and_stays_in_the_ring():
    pushed = run("ring", "push_out.py")
    assert np.hypot(*pushed.arena.thing_pose("other").at_m[:2]) > 0.385
    assert np.hypot(*pushed.trace.places_m.T).max() < 0.385


@pytest.mark.slow_variants
@pytest.mark.parametrize("seconds", [8, 30])
def test_a_robot_balances_on_two_wheels(seconds):
    balanced = run("balance", "balance.py", str(seconds))
    assert balanced.trace.column("time_s")[-1] > seconds
    assert np.abs(balanced.trace.column("pitch_deg")).max() < 5.0
    assert np.hypot(*balanced.trace.places_m.T).max() < 0.4


def test_a_robot_whose_program_does_nothing_falls():
    arena = open_arena(load_setting("balance"))
    arena.body.set_motor(1, 3, brake=True)  # a nudge
    let_pass(arena, 2.0)
    assert abs(arena.robot_pose().pitch_deg) > 60.0


def test_a_motor_on_a_bench_turns_as_fast_as_its_numbers_say():
    spun = run("bench", "spin_motor.py")
    turned = spun.trace.column("a_deg")[-26:]
    speed_rad_s = np.radians(turned[-1] - turned[0]) / 0.5
    # nxt-python leaves the winding open between pulses: it conducts for the duty's share of the time.
    supply_v = spun.arena.body.battery.terminal_v
    mean_a = 62 / 125 * (supply_v - 0.4908 * speed_rad_s) / 7.6
    assert 0.4908 * mean_a == pytest.approx(8.45e-3 + 1.92e-3 * speed_rad_s, rel=0.01)


def _walls(wandered):
    return wandered.arena.things.values()
