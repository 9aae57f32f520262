"""A robot and its ghost, in a world: they part when a wheel is another, and come together once that is known."""

from __future__ import annotations

from concurrent.futures import Executor, Future

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from nxt_twin.api.robots import WatchedRobot, usual_robot
from nxt_twin.brick.open import open_brick
from nxt_twin.cli.app import program
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.recording.configs import load_plant_config
from nxt_twin.twin import robot_twin
from nxt_twin.twin.legs import LEGS
from nxt_twin.twin.records import Innovation, Tick
from nxt_twin.twin.robot_twin import RobotTwin
from nxt_twin.twin.wheel_ghost import RobotReading
from nxt_twin.world.arena import open_arena
from nxt_twin.world.load import load_setting
from nxt_twin.world.pose import Heading


class AtOnce(Executor):
    """Does each thing when it is submitted."""

    def submit(self, fn, /, *args, **kwargs):
        done = Future()
        done.set_result(fn(*args, **kwargs))
        return done


def drive(twin, arena, legs):
    """What the twin says while a robot drives."""
    said, heading = [], Heading()
    for seconds, left, right in legs:
        for port, power in ((1, left), (2, right)):
            arena.body.set_motor(port, power, brake=True)
        for _ in range(round(seconds / 0.02)):
            for _ in range(20):
                arena.body.step()
            counts, pose = arena.body.tacho_counts(), arena.robot_pose()
            x_m, y_m = pose.at_m[:2].tolist()
            said += twin.see(RobotReading(arena.time_s, counts[1], counts[2], x_m, y_m, heading.of(pose)))
    return said


@pytest.fixture
def watched(tmp_path):
    def watch(radius_mm):
        path = tmp_path / "world.yaml"
        path.write_text(
            yaml.safe_dump({"robot": {"like": "castor_bot", "wheels": {"right": {"radius_mm": radius_mm}}}})
        )
        return RobotTwin(drive_from_config(load_plant_config("castor_bot")), AtOnce()), open_arena(
            load_setting(path)
        )

    return watch


def test_robot_and_ghost_part_at_a_smaller_wheel_are_told_why_and_are_together_again(watched):
    twin, arena = watched(27.0)
    said = drive(twin, arena, LEGS)
    assert [event.kind for event in said] == ["divergence", "effect_named", "adopted", "calm"]
    assert "unequal_wheels" in said[2].words
    assert twin.drive.geometry.wheel_radius_ratio == pytest.approx(27.0 / 28.0, abs=0.003)
    assert said[0].time_s < 4.0


def test_a_model_that_is_hardly_better_is_not_adopted(watched, monkeypatch):
    monkeypatch.setattr(robot_twin, "CLEARLY", 0.01)
    twin, arena = watched(27.0)
    assert [event.kind for event in drive(twin, arena, LEGS[:20])] == ["divergence", "undiagnosed"]
    assert twin.drive.geometry.wheel_radius_ratio == 1.0


@pytest.mark.parametrize(
    ("robot", "plant"),
    [("tribot", "tribot"), ({"like": "castor_bot", "wheels": {}}, "castor_bot"), ("arm", None)],
)
def test_a_robot_in_a_world_is_watched_by_the_plant_that_it_is_like(tmp_path, robot, plant):
    path = tmp_path / "world.yaml"
    path.write_text(yaml.safe_dump({"robot": robot}))
    assert usual_robot(f"mock:?world={path}") == plant


def test_robot_and_ghost_stay_together_where_the_model_is_right(watched):
    twin, arena = watched(28.0)
    assert drive(twin, arena, LEGS[:16]) == []


def hard(power):
    """Squares of the usual size at a higher power, at whose starts tyres slip."""
    faster = power / 35
    return [
        (max(seconds / faster, 0.25), power * np.sign(left), power * np.sign(right))
        if left
        else (seconds, 0, 0)
        for seconds, left, right in LEGS
    ]


@pytest.mark.slow_variants
@pytest.mark.parametrize("power", [80, 100])
def test_slip_at_hard_starts_does_not_part_robot_and_ghost(watched, power):
    twin, arena = watched(28.0)
    assert [event.kind for event in drive(twin, arena, 2 * hard(power))] == ["slip"]


@pytest.mark.slow_variants
@pytest.mark.parametrize("power", [80, 100])
def test_a_smaller_wheel_is_named_and_adopted_beside_slip_at_hard_starts(watched, power):
    twin, arena = watched(27.0)
    said = drive(twin, arena, 3 * hard(power))
    assert [event.kind for event in said] == ["slip", "divergence", "effect_named", "adopted", "calm"]
    assert said[3].words.startswith("the robot's model now holds wheel_radius, unequal_wheels, wheel_slip;")
    assert twin.drive.geometry.wheel_radius_ratio == pytest.approx(27.0 / 28.0, abs=0.005)


def test_a_session_shows_the_world_and_how_robot_and_ghost_part(tmp_path):
    path = tmp_path / "world.yaml"
    wall = {"box_mm": [20, 900, 150], "at_mm": [900, 0, 75]}
    robot = {"like": "tribot", "wheels": {"right": {"radius_mm": 26.0}}}
    path.write_text(yaml.safe_dump({"robot": robot, "scene": {"things": {"wall": wall}}}))
    clock, shown, said = VirtualClock(), [], []
    watched = WatchedRobot(drive_from_config(load_plant_config("castor_bot")), said.append, AtOnce())
    watched.show_in(shown.append)
    with open_brick(f"mock:?world={path}", clock, {"mock": watched.open}) as brick:
        for port in (1, 2):
            brick.motors.drive(port, 35)
        for number in range(60):
            clock.sleep(0.05)
            counts = [brick.motors.tacho_deg(port).value for port in (1, 2)]
            readings = tuple(
                Innovation(clock.now_s(), f"{port}_tacho_deg", "deg", count, count, 1.0)
                for port, count in zip("bc", counts, strict=True)
            )
            watched.tick(Tick(number, clock.now_s(), clock.now_s(), (), readings))
    scenery, *moments = shown
    names = [name for name, _ in scenery.bodies]
    assert names[0] == "robot/base"
    assert "things/wall" in names
    places = np.array([[moment.frames[0][:2], moment.ghost[:2]] for moment in moments])
    apart = np.hypot(*(places[:, 0] - places[:, 1]).T)
    assert len(moments) > 40
    assert apart[1] < 0.005
    assert apart[-1] > 0.01
    assert [event.kind for event in said][:1] == ["divergence"]


def test_a_ghost_is_watched_only_where_a_pose_can_be_seen():
    result = CliRunner().invoke(program(["live"]), ["live", "mock:", "--robot", "castor_bot", "--yes"])
    assert result.exit_code == 2
    assert "mock:?world=FILE" in result.output
