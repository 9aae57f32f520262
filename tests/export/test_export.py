"""What is exported moves as ours does, in the programs it is for."""

from __future__ import annotations

import csv
import json
import math
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pybullet
import pytest
from typer.testing import CliRunner

import nxt_twin as nt
from nxt_twin.cli.app import program
from nxt_twin.export.axis import Axis, axis_of, check_kind
from nxt_twin.export.formats import FORMATS, export
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config

STEP_S = 0.01
POWERS = np.repeat([100.0, 40.0, -70.0, 0.0, 15.0], 40)
"""Quick, slow, reversed, braked to rest, and a start against the friction."""


def plant(**changes: float | None) -> nt.Plant:
    config = {**load_plant_config("nxt_motor"), **changes}
    return plant_from_config({key: value for key, value in config.items() if value is not None}, "power_pct")


def our_angles_deg(motor: nt.Plant) -> np.ndarray:
    times_s = np.arange(len(POWERS)) * STEP_S
    commands = nt.Recording("commands", {"time_s": times_s, "a_power_pct": POWERS})
    return np.asarray(nt.simulate(motor, commands).columns["a_tacho_deg"])


def in_mujoco_deg(axis: Axis) -> np.ndarray:
    model = mujoco.MjModel.from_xml_string(export(axis, "mjcf").text)
    data = mujoco.MjData(model)
    angles = []
    for power in POWERS:
        angles.append(math.degrees(data.qpos[0]))
        data.ctrl[0] = power / 100.0 * axis.supply_v
        mujoco.mj_step(model, data, nstep=round(STEP_S / model.opt.timestep))
    return np.array(angles)


def in_python_deg(axis: Axis) -> np.ndarray:
    module: dict[str, object] = {}
    exec(export(axis, "python").text, module)
    state, angles = (0.0, 0.0, 0.0), []
    for power in POWERS:
        angles.append(math.degrees(state[0]))
        for _ in range(10):
            state = module["step"](state, power / 100.0 * axis.supply_v, 0.001)
    return np.array(angles)


@pytest.mark.parametrize(("inductance_h", "within_deg"), [(None, 0.3), (4.88e-3, 1.0)])
def test_the_actuator_moves_in_mujoco_as_ours_does(inductance_h, within_deg):
    motor = plant(inductance_h=inductance_h)
    ours, theirs = our_angles_deg(motor), in_mujoco_deg(axis_of(motor, "a"))
    assert np.ptp(ours) > 300.0
    assert np.abs(ours - theirs).max() < within_deg


@pytest.mark.parametrize("inductance_h", [None, 4.88e-3, 0.05])
def test_the_module_moves_as_ours_does(inductance_h):
    motor = plant(inductance_h=inductance_h)
    assert np.abs(our_angles_deg(motor) - in_python_deg(axis_of(motor, "a"))).max() < 0.2


def test_the_module_coasts_with_an_open_winding_and_brakes_with_a_closed_one():
    module: dict[str, object] = {}
    exec(export(axis_of(plant(), "a"), "python").text, module)
    ways = {}
    for closed in (True, False):
        state = (0.0, 10.0, 0.0)
        for _ in range(2_000):
            state = module["step"](state, 0.0, 0.001, closed=closed)
        assert state[1] == 0.0
        ways[closed] = state[0]
    assert ways[False] > 5.0 * ways[True] > 0.0


def test_the_joint_loads_in_bullet_with_its_friction_and_limits(tmp_path):
    axis = axis_of(plant(), "nxt motor")
    path = tmp_path / "motor.urdf"
    path.write_text(export(axis, "urdf").text)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        joint = pybullet.getJointInfo(pybullet.loadURDF(str(path), physicsClientId=client), 0, client)
    finally:
        pybullet.disconnect(client)
    assert joint[1] == b"nxt_motor"
    assert joint[6:8] == pytest.approx((axis.viscous_friction_nm_s_per_rad, axis.coulomb_friction_nm))
    assert joint[10:12] == pytest.approx((axis.stall_torque_nm, axis.free_speed_rad_per_s))
    inertia = ET.parse(path).find(".//inertia")
    assert float(inertia.get("izz")) == axis.inertia_kg_m2


def test_the_limits_of_the_joint_are_where_ours_stands_still_and_runs_free():
    axis = axis_of(plant(), "a")
    rising = our_angles_deg(plant())[25:38]
    assert math.degrees(axis.free_speed_rad_per_s) == pytest.approx(np.diff(rising).mean() / STEP_S, rel=0.02)


def test_the_table_names_simscapes_parameters():
    text = export(axis_of(plant(), "a"), "simscape-csv").text
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    values = {(row["block"], row["parameter"]): row["value"] for row in rows}
    assert float(values["DC Motor", "Armature inductance"]) == 4.88e-3
    assert float(values["Rotational Friction", "Coulomb friction torque"]) == 8.45e-3
    assert {row["unit"] for row in rows} >= {"Ohm", "H", "kg*m^2", "N*m/(rad/s)"}


def run(*arguments: str):
    return CliRunner().invoke(program(["export", "udev"]), ["export", *arguments])


@pytest.mark.parametrize("name", FORMATS)
def test_the_command_says_what_it_leaves_out(tmp_path, name):
    plant_file = tmp_path / "my motor.yaml"
    plant_file.write_text(
        "kind: dc_motor\nresistance_ohm: 7.6\ntorque_constant_nm_per_a: 0.49\nback_emf_v_s_per_rad: 0.49\n"
        "inertia_kg_m2: 1.2e-3\neffects: {constant_load: {load_torque_nm: 0.01}}\n"
    )
    out = tmp_path / "made"
    result = run(str(plant_file), "--to", name, "--out", str(out), "--json", str(tmp_path / "made.json"))
    assert result.exit_code == 0
    assert "left out: constant_load" in result.stderr
    text, answer = out.read_text(), json.loads((tmp_path / "made.json").read_text())
    assert "constant_load" in text
    assert "my_motor" in text
    assert answer["left_out"] == ["constant_load"]
    assert all(limit in " ".join(text.split()) or name == "python" for limit in answer["limits"])


def test_what_is_no_motor_is_refused():
    body = plant_from_config({"kind": "rigid_body", "inertia": 1.0}, "torque_nm")
    with pytest.raises(nt.NxtTwinError, match="only a plant of kind dc_motor"):
        axis_of(body, "body")


@pytest.mark.parametrize(
    ("model", "kind"), [("castor_bot", "differential_drive"), ("servo_sts3215", "servo")]
)
def test_a_built_in_plant_that_is_no_motor_is_refused_by_its_kind(model, kind):
    with pytest.raises(nt.NxtTwinError, match=f"{model}: is of kind {kind} .only a plant of kind dc_motor"):
        check_kind(load_plant_config(model), model)
