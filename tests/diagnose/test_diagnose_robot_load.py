"""A payload on a robot: how far it reaches is unknown, and its interval admits that."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnose_robot_cases import powered_case, robot_of_seed

from nxt_twin.diagnose.robot.engine import diagnose_robot

ADDED_KG = 0.6


@pytest.mark.parametrize("reach", [0.0, 0.3])
def test_the_interval_of_a_payload_admits_that_its_reach_is_unknown(reach):
    truth = robot_of_seed(5)
    more = truth.spin_kg_m2 * reach * ADDED_KG / truth.mass_kg
    loaded = replace(truth, mass_kg=truth.mass_kg + ADDED_KG, spin_kg_m2=truth.spin_kg_m2 + more)
    (effect,) = diagnose_robot(powered_case("loaded", loaded, 1)).diagnosis.effects
    assert effect.id == "payload_mass"
    low_kg, high_kg = effect.params["added_mass_kg"].interval_95
    assert low_kg < ADDED_KG < high_kg < 2.5 * ADDED_KG
