"""A robot of a world, driven by a program and logged with its powers, is diagnosed right by its plant."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from nxt_twin.diagnose.robot.engine import diagnose_robot
from nxt_twin.physics.robot.drive import drive_from_config
from nxt_twin.physics.robot.powered import powered_robot
from nxt_twin.recording.case import read_case
from nxt_twin.recording.configs import configs_dir, load_plant_config
from nxt_twin.world.arena import open_arena
from nxt_twin.world.assembly import ORIGIN
from nxt_twin.world.bullet import GRAVITY_M_S2
from nxt_twin.world.load import load_setting
from nxt_twin.world.program import run_program
from nxt_twin.world.trace import Trace

PROGRAM = Path(__file__).parents[2] / "examples" / "worlds" / "starts_and_turns.py"
CASTOR_BOT = yaml.safe_load((configs_dir() / "robots" / "castor_bot.yaml").read_text())
LOAD = {"name": "load", "box_mm": [60, 60, 40], "at_mm": [-38, 0, 130], "mass_g": 400}
SMALL = {**CASTOR_BOT["wheels"]["right"], "radius_mm": 27.4, "at_mm": [0, -51.5, 27.4]}
DRAGS = {"castor": {**CASTOR_BOT["glides"]["castor"], "friction": 0.25}}
LOADED = {"robot": {"like": "castor_bot", "parts": [*CASTOR_BOT["parts"], LOAD]}}


def motor(**changes):
    return {**load_plant_config("nxt_motor"), **changes}


@pytest.fixture
def diagnosed(tmp_path):
    def diagnose(world, plant="castor_bot"):
        """What a diagnosis says of three drives of a world's robot."""
        (tmp_path / "world.yaml").write_text(yaml.safe_dump(world))
        names = [f"drive_{seed}.csv" for seed in (1, 2, 3)]
        for seed, name in enumerate(names, start=1):
            arena = open_arena(load_setting(tmp_path / "world.yaml"))
            trace = Trace(arena)
            ran = run_program(arena, PROGRAM, (str(seed),), limit_s=60.0)
            assert (ran.ending, ran.said) == ("done", "")
            trace.write(tmp_path / name)
        case = {"plant": plant, "recordings": names}
        (tmp_path / "case.yaml").write_text(yaml.safe_dump(case))
        return diagnose_robot(read_case(tmp_path)).diagnosis

    return diagnose


@pytest.mark.slow
def test_a_clean_robot_of_a_world_lacks_nothing(diagnosed):
    found = diagnosed({"robot": "castor_bot"})
    assert (found.verdict, found.effects) == ("adequate", ())
    assert not any("motor" in name for name in found.refit)


@pytest.mark.slow
def test_a_payload_is_named_within_its_interval(diagnosed):
    found = diagnosed(LOADED)
    assert (found.verdict, [effect.key for effect in found.effects]) == ("explained", ["payload_mass"])
    low_kg, high_kg = found.effects[0].params["added_mass_kg"].interval_95
    assert low_kg < 0.4 < high_kg


@pytest.mark.slow
@pytest.mark.parametrize(
    ("world", "key", "name", "size"),
    [
        (
            {"robot": "castor_bot", "battery": {"internal_resistance_ohm": 2.5}},
            "battery_sag",
            "internal_resistance_ohm",
            2.5,
        ),
        (
            {
                "robot": "castor_bot",
                "motors": {"c": motor(effects={"quadratic_drag": {"quadratic_drag_nm_s2_per_rad2": 2e-3}})},
            },
            "right_motor.quadratic_drag",
            "quadratic_drag_nm_s2_per_rad2",
            2e-3,
        ),
    ],
)
def test_what_battery_and_motors_have_is_named_on_its_side(diagnosed, world, key, name, size):
    found = diagnosed(world)
    assert (found.verdict, [effect.key for effect in found.effects]) == ("explained", [key])
    assert found.effects[0].params[name].value == pytest.approx(size, rel=0.2)


@pytest.mark.slow
def test_a_payload_of_a_tribot_is_named_within_its_interval(diagnosed):
    parts = yaml.safe_load((configs_dir() / "robots" / "tribot.yaml").read_text())["parts"]
    found = diagnosed(
        {"robot": {"like": "tribot", "parts": [*parts, {**LOAD, "at_mm": [-33, 0, 140]}]}}, "tribot"
    )
    assert (found.verdict, [effect.key for effect in found.effects]) == ("explained", ["payload_mass"])
    low_kg, high_kg = found.effects[0].params["added_mass_kg"].interval_95
    assert low_kg < 0.4 < high_kg


@pytest.mark.slow
def test_a_caster_that_drags_is_named_alone(diagnosed):
    found = diagnosed({"robot": {"like": "castor_bot", "glides": DRAGS}})
    assert (found.verdict, [effect.key for effect in found.effects]) == ("explained", ["caster_drag"])
    # 0.084 N at a friction of 0.04.
    assert found.effects[0].params["drag_force_n"].value == pytest.approx(0.084 * 0.25 / 0.04, rel=0.1)


@pytest.mark.slow
def test_a_smaller_right_wheel_is_named(diagnosed):
    found = diagnosed({"robot": {"like": "castor_bot", "wheels": {**CASTOR_BOT["wheels"], "right": SMALL}}})
    effects = {effect.key: effect.params for effect in found.effects}
    assert (found.verdict, set(effects)) == ("explained", {"unequal_wheels", "wheel_radius"})
    ratio = effects["unequal_wheels"]["wheel_radius_ratio"].value
    assert ratio == pytest.approx(27.4 / 28.0, abs=5e-4)
    assert effects["wheel_radius"]["mean_wheel_radius_m"].value == pytest.approx(0.0277, abs=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("port", "side"), [("b", "left"), ("c", "right")])
def test_a_voltage_drop_is_told_on_its_side(diagnosed, port, side):
    world = {"robot": "castor_bot", "motors": {port: motor(effects={"voltage_drop": {"drop_v": 0.6}})}}
    found = diagnosed(world)
    assert (found.verdict, [effect.key for effect in found.effects]) == (
        "explained",
        [f"{side}_motor.voltage_drop"],
    )
    assert found.effects[0].params["drop_v"].value == pytest.approx(0.6, rel=0.03)


@pytest.mark.slow
def test_a_stiff_motor_is_told_on_its_side(diagnosed):
    found = diagnosed({"robot": "castor_bot", "motors": {"b": motor(coulomb_friction_nm=0.025)}})
    assert found.verdict == "adequate"
    moved = found.refit["left_motor.coulomb_friction_nm"]
    assert moved.after == pytest.approx(0.025, rel=0.3)
    assert "right_motor.coulomb_friction_nm" not in found.refit
    assert any("The left motor's Coulomb friction was re-fitted" in note for note in found.notes)


@pytest.mark.parametrize("name", ["castor_bot", "tribot"])
def test_the_plant_holds_what_the_robot_is_made_of(tmp_path, name):
    (tmp_path / "world.yaml").write_text(yaml.safe_dump({"robot": name}))
    robot = load_setting(tmp_path / "world.yaml").robot
    assembly = robot.assembly(dict.fromkeys("abc", 0.0))
    x_m, y_m, z_m = assembly.centre_m
    yaw_kg_m2 = 0.0
    for link in assembly.links:
        hangs_m = link.joint.at_m if link.joint else ORIGIN
        ahead_m, left_m = (link.centre_m[k] + hangs_m[k] for k in (0, 1))
        yaw_kg_m2 += link.inertia_kg_m2[2] + link.mass_kg * ((ahead_m - x_m) ** 2 + (left_m - y_m) ** 2)
    castor, wheel = robot.glides["castor"], robot.wheels["left"]
    weight_n, back_m = GRAVITY_M_S2 * assembly.mass_kg, -1e-3 * castor.at_mm[0]
    on_castor_n = weight_n * -x_m / back_m
    plant = powered_robot(drive_from_config(load_plant_config(name)))
    assert plant.values[[10, 11, 16]] == pytest.approx([assembly.mass_kg, yaw_kg_m2, x_m], rel=0.01)
    assert (plant.height_m, plant.caster_back_m) == pytest.approx((z_m, back_m), rel=0.01)
    assert plant.values[12] == pytest.approx(castor.friction * on_castor_n, rel=0.01)
    assert plant.values[18] == pytest.approx(1e-3 * wheel.scrub_mm * (weight_n - on_castor_n), rel=0.01)
