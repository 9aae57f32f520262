"""A plant on a joint moves it as it would move itself."""

from __future__ import annotations

import numpy as np
import pytest

from nxt_twin.errors import PlantError
from nxt_twin.physics.jointed import JointDrives
from nxt_twin.physics.modes import MODE_DRIVE, MODE_FLOAT
from nxt_twin.physics.plant import Plant, plant_from_config
from nxt_twin.physics.stepper import Stepper
from nxt_twin.recording.configs import load_plant_config

STEP_S = 1e-3


def motor(**effects: dict[str, float]) -> Plant:
    plain = effects.pop("plain", {})
    return plant_from_config({**load_plant_config("nxt_motor"), **plain, "effects": effects}, "power_pct")


def on_a_body(drives: JointDrives, joint: np.ndarray) -> None:
    """The joint's body: its inertia is the plant's, and dry friction stops it at most."""
    torque, friction = drives.exerted.T
    free = joint[:, 1] + torque * STEP_S / drives.inertia_kg_m2
    bite = friction * STEP_S / drives.inertia_kg_m2
    after = np.sign(free) * np.maximum(np.abs(free) - bite, 0.0)
    joint[:, 0] += 0.5 * STEP_S * (joint[:, 1] + after)
    joint[:, 1] = after


@pytest.mark.parametrize("mode", [MODE_DRIVE, MODE_FLOAT])
@pytest.mark.parametrize(
    "effects",
    [
        {},
        {
            "plain": {"current_limit_a": 0.4},
            "gravity_load": {"gravity_torque_nm": 0.03, "phase_deg": 20.0},
        },
        {"winding_heating": {"resistance_rise_per_joule": 0.1, "thermal_time_constant_s": 60.0}},
        {"command_delay": {"delay_s": 0.02}},
        {"presliding": {"presliding_deg": 1.0}},
    ],
    ids=lambda effects: "+".join(effects) or "plain",
)
def test_a_joint_moves_as_the_plant_by_itself(effects, mode):
    plant = motor(**effects)
    stepper, drives = Stepper([plant]), JointDrives([plant])
    joint, own, theirs = np.zeros((1, 2)), [], []
    modes = np.array([mode])
    for n in range(600):
        duty = np.array([0.6 if n < 300 else -0.3])
        stepper.step(duty, modes, 8.0, STEP_S)
        drives.turn(joint, duty, modes, 8.0, STEP_S)
        on_a_body(drives, joint)
        own.append(stepper.angle[0])
        theirs.append(joint[0, 0])
    assert np.abs(np.array(own) - theirs).max() < 0.02 * np.ptp(own)


def test_a_plant_with_a_body_of_its_own_is_refused():
    plant = motor(backlash={"gap_deg": 6.0, "load_inertia_kg_m2": 6e-4})
    with pytest.raises(PlantError, match="backlash"):
        JointDrives([plant])
