"""The command `world`, and the mock on a robot, as a user has them."""

from __future__ import annotations

import json
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick
from nxt_twin.cli.app import program
from nxt_twin.errors import CaseError, NxtTwinError
from nxt_twin.mock.errors import WorldError
from nxt_twin.mock.run import serve
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.thread import served_in_thread
from nxt_twin.recording.files import read_recording
from nxt_twin.world import bullet
from nxt_twin.world.arena import open_arena
from nxt_twin.world.load import load_setting

PLAYGROUND = Path(__file__).parents[2] / "configs" / "worlds" / "playground.yaml"

AHEAD = """
import time
import nxt.locator, nxt.motor
with nxt.locator.find() as brick:
    print("found", brick.get_device_info()[0])
    began = time.monotonic()
    for port in (nxt.motor.Port.B, nxt.motor.Port.C):
        brick.get_motor(port).run(40)
    while time.monotonic() - began < 0.5:
        pass
    assert brick.get_motor(nxt.motor.Port.B).get_tacho().rotation_count > 50
    {then}
"""


def run(*arguments: str):
    return CliRunner().invoke(program(["world", "mock"]), ["world", *arguments])


@pytest.fixture
def ahead(tmp_path: Path):
    def write(then: str = "") -> str:
        path = tmp_path / "ahead.py"
        path.write_text(AHEAD.format(then=then))
        return str(path)

    return write


def test_a_program_that_waits_by_looking_at_the_clock_drives_the_robot(ahead, tmp_path):
    trace = tmp_path / "course.csv"
    result = run("playground", "--program", ahead(), "--trace", str(trace), "--json", "-")
    assert result.exit_code == 0
    told = json.loads(result.stdout)
    assert told["schema"] == "nxt-twin/world/1"
    assert told["robot"]["x_m"] == pytest.approx(0.028 * told["motors_deg"]["b"] / 57.3, rel=0.02)
    assert 0.5 <= told["elapsed_s"] < 0.7
    assert "found Castor" in result.stderr
    recorded = read_recording(trace)
    assert recorded.columns["pose_x_m"][-1] == pytest.approx(told["robot"]["x_m"], abs=8e-3)
    assert recorded.columns["b_tacho_deg"][-1] == pytest.approx(told["motors_deg"]["b"], abs=16.0)
    powers = recorded.columns["b_power_pct"]
    begins = int(np.argmax(powers > 0.0))
    assert (powers[begins], powers[begins - 1]) == (40.0, 0.0)
    turned = recorded.time_s[np.argmax(recorded.columns["b_tacho_deg"] >= 2.0)]
    assert 0.0 < turned - recorded.time_s[begins] < 0.08
    assert "a_power_pct" not in recorded.columns
    assert recorded.columns["battery_v"].min() < recorded.columns["battery_v"][0] - 0.05


def test_a_program_that_fails_is_told_with_its_line(ahead):
    result = run("playground", "--program", ahead("raise ValueError('no way')"))
    assert result.exit_code == 1
    assert "ahead.py, line 12: ValueError: no way" in result.stderr
    assert "Traceback" not in result.output


def test_a_program_that_never_ends_is_stopped(ahead):
    result = run("playground", "--seconds", "0.6", "--program", ahead("while True: time.sleep(0.01)"))
    assert result.exit_code == 1
    assert "still running after 0.6 s" in result.stderr


def test_two_runs_are_alike_to_the_last_bit(ahead):
    script = ahead()
    first, second = (
        json.loads(run("playground", "--program", script, "--json", "-").stdout) for _ in range(2)
    )
    del first["times_real_time"], second["times_real_time"]
    assert first == second


@pytest.mark.parametrize("world", ["playground", str(PLAYGROUND)])
def test_the_mock_stands_on_a_robot_too_by_name_or_file(world):
    with open_brick(f"mock:?world={world}", VirtualClock(), OPENERS) as brick:
        assert brick.device.info().value.name == "Castor"


def test_a_program_on_the_fake_usb_drives_the_robot_of_a_named_world(ahead):
    program_on_it = ["mock", "--world", "playground", "--usb-fake", ahead()]
    told = CliRunner().invoke(program(["world", "mock"]), program_on_it)
    assert (told.exit_code, "found Castor" in told.output) == (0, True)


TO_THE_WALL = """
import sys, time
import nxt.locator, nxt.motor, nxt.sensor, nxt.sensor.generic
with nxt.locator.find(backends=["socket"], config=None, server_port=sys.argv[1]) as brick:
    motors = [brick.get_motor(port) for port in (nxt.motor.Port.B, nxt.motor.Port.C)]
    sonar = brick.get_sensor(nxt.sensor.Port.S4, nxt.sensor.generic.Ultrasonic)
    first = sonar.get_distance()
    while sonar.get_distance() > first - 5:
        for motor in motors:
            motor.run(60)
    for motor in motors:
        motor.brake()
    counts = [motor.get_tacho().rotation_count for motor in motors]
    print(brick.get_device_info()[0], first, *counts)
"""


def test_a_program_in_a_process_of_its_own_drives_the_robot_over_tcp(tmp_path):
    script, arenas = tmp_path / "to_the_wall.py", []
    script.write_text(TO_THE_WALL)

    def bodies(_, file, seed, **__):
        arenas.append(open_arena(load_setting(file), seed))
        return arenas[-1].body

    places = {"tcp_raw": "127.0.0.1:0", "world": Path("wall")}
    with served_in_thread(partial(serve, clock=SystemClock(), bodies=bodies, **places)) as served:
        port = served.urls[0].rpartition(":")[2]
        ran = subprocess.run(
            [sys.executable, script, port], capture_output=True, text=True, timeout=60, check=False
        )
    assert ran.returncode == 0, ran.stderr
    name, first_cm, *counts = ran.stdout.split()
    ahead_m = float(arenas[0].robot_pose().at_m[0])
    assert (name, float(first_cm)) == ("Wall", pytest.approx(115.0, abs=8.0))
    assert ahead_m > 0.04
    assert [0.028 * np.radians(int(one)) for one in counts] == pytest.approx([ahead_m] * 2, abs=0.015)


def test_a_misspelt_world_of_a_mock_is_refused_with_the_nearest():
    with pytest.raises(WorldError, match="nearest known: playground"):
        open_brick("mock:?world=playgrond", VirtualClock(), OPENERS)


def test_nothing_is_concealed_in_a_motor_that_moves_the_robot():
    arm = PLAYGROUND.with_name("arm.yaml")
    with pytest.raises(CaseError, match="motor A"):
        open_brick(f"mock:?world={arm}&conceal=5", VirtualClock(), OPENERS)
    open_brick(f"mock:?world={PLAYGROUND}&conceal=5", VirtualClock(), OPENERS).close()


def test_without_pybullet_the_command_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pybullet", None)
    bullet.pybullet_module.cache_clear()
    with pytest.raises(NxtTwinError, match=r"pip install 'nxt-twin\[world\]'"):
        open_brick(f"mock:?world={PLAYGROUND}", VirtualClock(), OPENERS)
    bullet.pybullet_module.cache_clear()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("robot: castor_bt\n", "castor_bot"),
        ("name: X\n", "holds no robot"),
        (
            "robot: castor_bot\nscene: {flor: {}}\n",
            r"bad.yaml, line 2, scene, key flor: unknown key \(nearest known: floor\)",
        ),
        ("robot: castor_bot\nscene:\n  start: {\n    at_mm: [a, 2]}\n", r"line 4, scene, key start\.at_mm"),
        ("robot: {name: X, parts: [{mass_g: 3}]}\n", "give one of box_mm"),
        ("robot: {name: X, parts: [{box_mm: [1, 2, 0], mass_g: 3}]}\n", r"parts\.0\.box_mm"),
        ("robot: castor_bot\n  scene: {\n", "line 2"),
        (
            "robot: castor_bot\nscene: {things: {ball: {sphere_mm: 50, weight: 3}}}\n",
            r"key things\.ball\.weight: unknown key",
        ),
        (
            "robot: {name: X, parts: [{box_mm: [1, 2, 3], mass_g: 3}], sensors: {4: {kind: ultrasonic}}}\n",
            r"robot, key sensors\.4\.at_mm: is missing",
        ),
        ("robot: {like: castor_bt}\n", r"bad.yaml, line 1, key robot\.like: .*castor_bot"),
        ("name: X\nrobot: mine.yaml\n", r"bad.yaml, line 2, key robot: there is no file 'mine.yaml'"),
        (
            "robot: {like: castor_bot, wheels: {right: {port: b}}}\n",
            r"line 1, robot, key wheels: left and right are on one port, b",
        ),
        (
            "robot: castor_bot\nmotors: {b: worn}\n",
            r"bad.yaml, line 2, key motors\.b: .*no plant named 'worn'",
        ),
        (
            "robot: castor_bot\nscene: {floor: {prints: [{patch_mm: [[0, 0], [9, 9]], picture: map.png}]}}\n",
            r"line 2, scene\.floor, key prints\.0\.picture: map.png: there is no such file",
        ),
        (
            "robot:\n  like: line_follower\n  sensors:\n    3: {model: nxt_ligt}\n",
            r"line 4, robot, key sensors\.3: .*nxt_light",
        ),
    ],
)
def test_a_bad_world_file_is_refused_by_file_line_and_key(tmp_path, text, told):
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(WorldError, match=told) as caught:
        open_arena(load_setting(path))
    assert "\n" not in str(caught.value)
    assert "bad.yaml" in str(caught.value)
