"""A plant that turns further by one motion of its inputs."""

import pytest

from nxt_twin.physics.further import turning_further
from nxt_twin.physics.plant import plant_from_config

BODY = {"kind": "rigid_body", "inertia": 2e-3, "coulomb_friction": 0.01}


def test_under_a_given_torque_friction_stays_and_inertia_falls():
    plant = plant_from_config(BODY, "torque_nm")
    further = turning_further(plant, 2.0, "torque_nm").to_config()
    assert further["coulomb_friction"] == pytest.approx(0.01)
    assert further["inertia"] == pytest.approx(1e-3)


def test_nothing_changes_where_a_motor_turns_as_far():
    plant = plant_from_config(BODY, "torque_nm")
    assert turning_further(plant, 1.0, "torque_nm") == plant
