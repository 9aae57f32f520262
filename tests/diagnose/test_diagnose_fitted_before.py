"""A model that was fitted to a motor without the physics that it lacks: its numbers say little of the motor."""

import math
from pathlib import Path

import numpy as np
import pytest

import nxt_twin as nt
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.recording.case import Case

MOTOR = nt.load_plant("nxt_motor").to_config()
ARM_NM = 0.12
STEP_S, POLL_S, LENGTH_S = 2e-4, 0.01, 12.0


def swung(name, seed):
    """Twelve seconds of a motor that swings an arm behind a slow loop, by Euler's method; friction is a smooth step."""
    rng = np.random.default_rng(seed)
    constant, gain = MOTOR["torque_constant_nm_per_a"], rng.uniform(0.8, 1.4)
    angle = speed = duty = 0.0
    rows = []
    for step in range(round(LENGTH_S / STEP_S)):
        now_s = step * STEP_S
        if step % round(POLL_S / STEP_S) == 0:
            goal_deg = 80.0 * math.sin(1.3 * now_s) + 40.0 * math.sin((2.9 + 0.1 * seed) * now_s)
            seen_deg = math.floor(math.degrees(angle) + 0.5)
            duty = float(np.clip(round(gain * (goal_deg - seen_deg)), -100, 100))
            rows.append((now_s, duty, seen_deg))
        current = (duty / 100 * MOTOR["supply_v"] - constant * speed) / MOTOR["resistance_ohm"]
        friction = MOTOR["coulomb_friction_nm"] * math.tanh(speed / 0.02)
        friction += MOTOR["viscous_friction_nm_s_per_rad"] * speed
        torque = constant * current - friction - ARM_NM * math.sin(angle)
        speed += STEP_S * torque / MOTOR["inertia_kg_m2"]
        angle += STEP_S * speed
    time_s, power, position = np.array(rows).T
    return nt.Recording(name, {"time_s": time_s, "a_power_pct": power, "a_tacho_deg": position})


@pytest.mark.slow
def test_an_arm_that_a_fit_took_for_friction_is_named():
    runs = [swung(f"r{n}", seed=n) for n in range(4)]
    bare = {key: value for key, value in MOTOR.items() if key != "inductance_h"}
    fitted = nt.fit(runs[0], bare).to_config()
    found = diagnose(Case("arm", Path(), fitted, tuple(runs[1:3]), (runs[3],), "a")).diagnosis
    assert found.verdict == "explained"
    (arm,) = found.effects
    assert arm.id == "gravity_load"
    assert arm.params["gravity_torque_nm"].value == pytest.approx(ARM_NM, rel=0.1)
