"""A robot in MuJoCo as foreign truth: its physics and its solver are nobody's here."""

import math

import numpy as np
import pytest

from nxt_twin.diagnose.robot.engine import diagnose_robot
from nxt_twin.recording.case import case_of
from nxt_twin.recording.recording import Recording

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.slow

VOLTS, STEP_S, ROW_STEPS = 7.9, 5e-4, 40
PLANT = {
    "kind": "differential_drive",
    "left": "b",
    "right": "c",
    "left_wheel_radius_m": 0.028,
    "right_wheel_radius_m": 0.028,
    "track_m": 0.12,
    "motor": {
        "resistance_ohm": 7.6,
        "back_emf_v_s_per_rad": 0.4908,
        "coulomb_friction_nm": 8.45e-3,
        "viscous_friction_nm_s_per_rad": 1.92e-3,
        "inertia_kg_m2": 1.2e-3,
        "supply_v": VOLTS,
    },
    "mass_kg": 0.70,
    "yaw_inertia_kg_m2": 0.0014,
    "caster_back_m": 0.09,
}
HEAD = """
<mujoco><option timestep="0.0005" gravity="{gravity}" integrator="implicitfast" cone="elliptic" impratio="10"/>
<default><geom solref="0.002 1" solimp="0.99 0.999 0.0001" friction="4 1e-5 0" condim="4"/></default>
<worldbody><geom type="plane" size="20 20 .1"/><body><freejoint/>
<geom type="box" size=".06 .04 .025" pos="0 0 .06" mass="0.62" contype="0" conaffinity="0"/>
"""
SKID = '<geom type="sphere" size=".01" pos="{} 0 .0101" mass=".01" friction="0 0 0" priority="1" condim="3"/>'
LOAD = '<geom type="box" size=".03 .03 .02" pos="0 0 .10" mass="{}" contype="0" conaffinity="0"/>'
WHEEL = """
<body name="{name}" pos="0 {y} {radius}">
<joint name="{name}" axis="0 1 0" armature="1.2e-3" damping="1.92e-3" frictionloss="8.45e-3"/>
<geom type="sphere" size="{radius}" mass="0.03"/></body>
"""


def _robot(*, right_m=0.028, load_kg=0.0, slope_deg=0.0, uphill_deg=0.0):
    slope, uphill = math.radians(slope_deg), math.radians(uphill_deg)
    down = (-math.sin(slope) * math.cos(uphill), -math.sin(slope) * math.sin(uphill), -math.cos(slope))
    text = HEAD.format(gravity=" ".join(f"{9.81 * each:.9g}" for each in down))
    text += SKID.format("-.09") + SKID.format(".07") + (LOAD.format(load_kg) if load_kg else "")
    text += WHEEL.format(name="left", y=0.06, radius=0.028) + WHEEL.format(
        name="right", y=-0.06, radius=right_m
    )
    return mujoco.MjModel.from_xml_string(text + "</body></worldbody></mujoco>")


def _legs(rng):
    """Seconds and both powers: straight at three powers, squares both ways round, arcs, turns on the spot."""
    rest = (0.4, 0, 0)
    for power in (35, 50, 60):
        yield from ((1.5, power, power), rest, (1.5, -power, -power), rest)
    for way in (1, -1):
        for _ in range(4):
            yield from ((1.8, 45, 45), rest, (float(rng.uniform(0.6, 0.9)), -35 * way, 35 * way), rest)
    yield from ((2.5, 30, 50), rest, (2.5, 50, 30), rest, (1.2, 50, -50), rest, (1.2, -50, 50), rest)


def _drive(name, seed, **truth):
    """One recording: every 0.02 s whole degrees, and the pose with noise of half a millimetre."""
    model, rng = _robot(**truth), np.random.default_rng(seed)
    data, rows = mujoco.MjData(model), []
    joints = [model.joint(side) for side in ("left", "right")]
    for seconds, *powers in [(0.5, 0, 0), *_legs(rng)]:
        for step in range(ROW_STEPS * round(seconds / (STEP_S * ROW_STEPS))):
            if step % ROW_STEPS == 0:
                x, y, _, w, i, j, k = data.qpos[:7]
                yaw = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
                counts = [math.floor(math.degrees(data.qpos[joint.qposadr[0]])) for joint in joints]
                rows.append((data.time, *powers, *counts, x, y, yaw))
            for joint, power in zip(joints, powers, strict=True):
                current = (VOLTS * power / 100 - 0.4908 * data.qvel[joint.dofadr[0]]) / 7.6
                data.qfrc_applied[joint.dofadr[0]] = 0.4908 * current
            mujoco.mj_step(model, data)
    time_s, left, right, left_deg, right_deg, x, y, yaw = np.array(rows).T
    noise = rng.standard_normal((3, time_s.size))
    columns = {
        "time_s": time_s,
        "b_power_pct": left,
        "c_power_pct": right,
        "b_tacho_deg": left_deg,
        "c_tacho_deg": right_deg,
        "pose_x_m": x + 5e-4 * noise[0],
        "pose_y_m": y + 5e-4 * noise[1],
        "pose_heading_deg": np.degrees(np.unwrap(yaw)) + 0.1 * noise[2],
    }
    return Recording(name, columns)


def _diagnosed(**truth):
    runs = [_drive(f"foreign_{seed}.csv", seed, **truth) for seed in (1, 2, 3)]
    found = diagnose_robot(case_of(runs, PLANT)).diagnosis
    return found.verdict, {effect.id: effect.params for effect in found.effects}


def test_a_clean_foreign_robot_lacks_nothing():
    assert _diagnosed() == ("adequate", {})


def test_a_foreign_floor_that_is_not_level():
    verdict, effects = _diagnosed(slope_deg=3.0, uphill_deg=40.0)
    assert (verdict, set(effects)) == ("explained", {"floor_slope"})
    assert effects["floor_slope"]["slope_deg"].value == pytest.approx(3.0, abs=0.3)
    assert effects["floor_slope"]["uphill_heading_deg"].value == pytest.approx(40.0, abs=3.0)


def test_a_foreign_payload():
    verdict, effects = _diagnosed(load_kg=0.4)
    assert (verdict, set(effects)) == ("explained", {"payload_mass"})
    low, high = effects["payload_mass"]["added_mass_kg"].interval_95
    assert low < 0.4 < high


def test_a_foreign_wheel_that_is_smaller():
    verdict, effects = _diagnosed(right_m=0.0268)
    assert (verdict, set(effects)) == ("explained", {"wheel_radius", "unequal_wheels"})
    assert effects["unequal_wheels"]["wheel_radius_ratio"].value == pytest.approx(0.0268 / 0.028, abs=2e-3)
