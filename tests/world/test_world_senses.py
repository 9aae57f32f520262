"""What sensors make of a world, against where things stand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from firmware_protocol import SensorType
from firmware_protocol.ultrasonic import ADDRESS, UltrasonicRegister
from nxt_twin.world.arena import Arena, open_arena
from nxt_twin.world.floor import FloorPicture
from nxt_twin.world.load import load_setting
from nxt_twin.world.scene import Floor

PLAIN = {
    "name": "plain",
    "fixed": True,
    "parts": [{"box_mm": [40, 40, 40], "at_mm": [-60, 0, 100], "mass_g": 100}],
}


@pytest.fixture
def made(tmp_path):
    def make(sensors: dict, *, fixed: bool = True, **scene) -> Arena:
        robot = {
            **PLAIN,
            "fixed": fixed,
            "sensors": sensors,
            "wheels": {"w": {"port": "a", "at_mm": [0, 0, 300], "radius_mm": 20}},
        }
        path = tmp_path / "world.yaml"
        path.write_text(yaml.safe_dump({"robot": robot, "scene": scene}))
        return open_arena(load_setting(path))

    return make


def plugged(arena: Arena, port: int):
    return arena.body.sensors[port - 1].sensor


def sonar(arena: Arena, port: int = 4) -> tuple[float, float]:
    return plugged(arena, port).distance_cm.nearest()


WALL = {"box_mm": [10, 3000, 1000], "at_mm": [505, 0, 500]}
AHEAD = {4: {"kind": "ultrasonic", "at_mm": [0, 0, 150]}}


def test_an_echo_comes_from_the_nearest_thing(made):
    pole = {"cylinder_mm": [40, 400], "at_mm": [320, 0, 200]}
    assert sonar(made(AHEAD, things={"wall": WALL}))[0] == pytest.approx(500.0, abs=0.5)
    assert sonar(made(AHEAD, things={"wall": WALL, "pole": pole}))[0] == pytest.approx(300.0, abs=2.0)


@pytest.mark.parametrize(("turned", "heard"), [(0, True), (30, True), (50, True), (65, False)])
def test_a_wall_is_heard_up_to_the_angle_of_the_beam(made, turned, heard):
    wall = {"box_mm": [10, 4000, 4000], "at_mm": [445, 0, 0], "turned_deg": [0, 0, turned]}
    distance_mm, angle_deg = sonar(made(AHEAD, things={"wall": wall}))
    assert (distance_mm < 500.0) == heard
    if heard:
        assert angle_deg == pytest.approx(turned, abs=1.0)
        assert 440.0 * math.cos(math.radians(turned)) - 15.0 < distance_mm < 450.0


def test_the_floor_is_not_heard_nor_the_robot_itself(made):
    arena = made({4: {"kind": "ultrasonic", "at_mm": [-60, 0, 100]}})
    assert sonar(arena)[0] > 2550.0
    assert plugged(arena, 4).distance_cm.at(0.0) == 255.0


def test_readings_scatter_as_the_model_says_and_two_sensors_disturb_each_other(made):
    near = {port: {"kind": "ultrasonic", "at_mm": [0, 40 * port, 150]} for port in (3, 4)}
    arena = made(near, things={"wall": {**WALL, "at_mm": [1505, 0, 500]}})
    alone = [plugged(arena, 4).distance_cm.at(0.0) for _ in range(300)]
    assert np.mean(alone) == pytest.approx(0.1 * (1.0055 * 1500.0 + 13.0), abs=0.5)
    arena.body.sensors[2].set_type(0x0B)
    disturbed = [plugged(arena, 4).distance_cm.at(0.0) for _ in range(300)]
    # A foreign ping comes first with probability 1.52 m over the 6.9 m that sound makes out and back between pings.
    assert np.mean(np.array(disturbed) < 140.0) == pytest.approx(1.4 / 6.87, abs=0.07)


def test_a_reading_of_a_moving_thing_is_held_until_the_next_ping(made):
    ball = {"ball": {"sphere_mm": 50, "at_mm": [0, 0, 1650], "mass_g": 20}}
    arena = made({4: {"kind": "ultrasonic", "at_mm": [0, 0, 350], "facing_deg": [-90, 0]}}, things=ball)
    sensor = plugged(arena, 4)
    sensor.set_type(SensorType.LOW_SPEED_9V)
    seen, height_mm = [], []
    for _ in range(441):
        assert sensor.i2c_write(bytes([ADDRESS, UltrasonicRegister.MEASUREMENT]), arena.time_s)
        seen.append(sensor.i2c_read(1, arena.time_s)[0])
        height_mm.append(1e3 * float(arena.thing_pose("ball").at_m[2]))
        arena.body.step()
    pings = np.arange(0, 441, 40)
    assert set(np.flatnonzero(np.diff(seen)) + 1) <= set(pings)
    assert np.count_nonzero(np.diff(seen)) >= 8
    distance_mm = np.array(height_mm)[pings] - 25.0 - 350.0
    assert np.array(seen)[pings] == pytest.approx(0.1 * (1.0055 * distance_mm + 13.0), abs=3.0)


def light(arena: Arena, *, lit: bool = True) -> float:
    sensor = plugged(arena, 3)
    shown = sensor.lit_raw if lit else sensor.raw
    return float(np.mean([shown.at(10.0 + 0.003 * n) for n in range(60)]))


def test_the_lamps_light_is_a_mean_over_its_spot_and_fades_with_height(made):
    down = {3: {"kind": "light", "at_mm": [0, 0, 10], "facing_deg": [90, 0]}}
    edge = {"patch_mm": [[0, -100], [100, 100]], "shade": 0.1}
    on_white, on_edge, on_black = (
        light(made(down, floor={"shade": 0.9, "prints": prints}))
        for prints in ([], [edge], [{"patch_mm": [[-100, -100], [100, 100]], "shade": 0.1}])
    )
    assert on_white == pytest.approx(420.0 + 1.2 * 297.0 * 0.1, abs=2.0)
    assert on_black == pytest.approx(420.0 + 1.2 * 297.0 * 0.9, abs=2.0)
    assert on_edge == pytest.approx(0.5 * (on_white + on_black), abs=15.0)
    high = {3: {"kind": "light", "at_mm": [0, 0, 25], "facing_deg": [90, 0]}}
    assert light(made(high, floor={"shade": 0.9})) == pytest.approx(420.0 + 1.2 * 297.0 * 0.55, abs=2.0)


def test_room_light_and_lamps_reach_a_sensor_without_its_own(made):
    ahead = {3: {"kind": "light", "at_mm": [0, 0, 100]}}
    dark = light(made(ahead), lit=False)
    assert light(made(ahead, room={"light_raw": 80.0}), lit=False) == pytest.approx(dark - 80.0, abs=2.0)
    lamp = {"at_mm": [2000, 0, 100], "raw_at_1_m": 200.0}
    assert light(made(ahead, lamps=[lamp]), lit=False) == pytest.approx(dark - 50.0, abs=2.0)


@pytest.mark.parametrize("mains_hz", [100.0, 120.0])
def test_lamps_on_the_mains_flicker_by_the_amplitude_and_at_the_frequency_of_the_room(made, mains_hz):
    room = {"light_raw": 80.0, "mains_raw": 20.0, "mains_hz": mains_hz}
    arena = made({3: {"kind": "light", "at_mm": [0, 0, 100]}}, room=room)
    time_s = 10.0 + 0.003 * np.arange(400)
    seen = np.array([plugged(arena, 3).raw.at(float(time)) for time in time_s])
    wave = np.abs(np.exp(-2j * np.pi * np.outer((mains_hz, 87.0), time_s)) @ (seen - seen.mean())) / 200.0
    assert wave[0] == pytest.approx(20.0, abs=1.0)
    assert wave[1] < 3.0


def test_a_light_reading_is_held_for_three_milliseconds(made):
    shown = plugged(made({3: {"kind": "light", "at_mm": [0, 0, 150]}}), 3).raw
    seen = np.array([shown.at(0.001 * n) for n in range(2000)])
    changes = np.flatnonzero(np.diff(seen)) + 1
    assert changes.size > 300
    assert not (changes % 3).any()


def test_a_thing_before_the_sensor_is_seen_by_its_shade(made):
    ahead = {3: {"kind": "light", "at_mm": [0, 0, 100]}}
    seen = [
        light(made(ahead, things={"ball": {"sphere_mm": 50, "at_mm": [35, 0, 100], "shade": shade}}))
        for shade in (0.6, 0.15)
    ]
    assert seen[1] - seen[0] == pytest.approx(1.2 * 297.0 * 0.45, abs=3.0)


def test_a_button_closes_at_its_travel_and_opens_at_less(made):
    arena = made({1: {"kind": "touch", "at_mm": [0, 0, 100], "bumper_mm": [10, 40, 40]}}, things={})
    sensor, push = (
        plugged(arena, 1),
        np.concatenate([np.linspace(0.0, 0.9, 60), np.linspace(0.9, 0.0, 60)]),
    )
    closed = []
    client, number = arena.engine.client
    link = arena.engine._links[arena.robot]["sensor 1"]
    for force_n in push:
        for _ in range(40):
            place = client.getLinkState(arena.robot, link, physicsClientId=number)[0]
            client.applyExternalForce(
                arena.robot, link, [-force_n, 0, 0], place, client.WORLD_FRAME, physicsClientId=number
            )
            arena.body.step()
        closed.append(sensor.pressed.at(arena.time_s))
    grams = push / 9.81e-3
    assert grams[closed.index(1.0)] == pytest.approx(61.6, abs=4.0)
    opened = 119 - closed[::-1].index(1.0)
    assert 50.0 < grams[opened] < grams[closed.index(1.0)] - 1.0


def test_sound_falls_by_6_db_where_the_distance_doubles(made):
    def heard(x_mm: float) -> float:
        ear = {2: {"kind": "sound", "at_mm": [0, 0, 100]}}
        arena = made(ear, sounds=[{"at_mm": [x_mm, 0, 100], "db_at_1_m": 80.0}], room={"noise_db": 0.0})
        return plugged(arena, 2).raw._measure.__self__.heard(0.0)[0]

    assert heard(1000.0) == pytest.approx(80.0, abs=0.01)
    assert heard(2000.0) == pytest.approx(73.98, abs=0.01)


def test_a_floor_shows_lines_discs_patches_and_gradients():
    floor = Floor.model_validate(
        {
            "size_mm": [400, 400],
            "shade": 0.8,
            "prints": [
                {"line_mm": [[-150, 0], [150, 0]], "width_mm": 20, "shade": 0.1},
                {"disc_mm": [0, 100], "width_mm": 40, "shade": 0.2},
                {"gradient_mm": [[-100, -150], [100, -50]], "shade": 0.0, "to_shade": 1.0},
            ],
        }
    )
    places = 1e-3 * np.array([(0, 0), (0, 15), (10, 105), (0, -100), (50, -100), (500, 0)])
    shades = FloorPicture(floor, Path("world.yaml")).shade(places)
    assert shades == pytest.approx([0.1, 0.8, 0.2, 0.5, 0.75, 0.8], abs=0.02)
