"""What found effects leave at each horizon, and numbers that a fit moved to a bound."""

from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.judging.evidence import _leaves_most
from nxt_twin.diagnose.judging.horizons import Errors
from nxt_twin.diagnose.telling.bounds import at_bounds
from nxt_twin.physics.plant import plant_from_config

GIVEN = plant_from_config(
    {
        "kind": "dc_motor",
        "resistance_ohm": 6.86,
        "torque_constant_nm_per_a": 0.477,
        "back_emf_v_s_per_rad": 0.477,
        "coulomb_friction_nm": 0.0072,
        "viscous_friction_nm_s_per_rad": 0.0011,
        "inertia_kg_m2": 0.0013,
        "supply_v": 8.0,
    },
    "power_pct",
)
VISCOUS = next(
    slot for slot, one in GIVEN.layout.parameters.items() if one.name.startswith("viscous_friction")
)


def errors(*rms):
    return Errors((0.5, 2.0, np.inf), np.array(rms))


@pytest.mark.parametrize(
    ("after", "tolerance", "left"),
    [
        ((2.0, 5.9, 5.9), 1.0, False),
        ((2.0, 6.1, 2.0), 1.0, True),
        ((2.0, 3.1, 6.1), 1.0, True),
        ((2.0, 3.1, 6.1), 4.2, False),
        ((2.0, 2.0, np.inf), 4.2, True),
    ],
)
def test_most_of_an_error_is_left_where_half_of_it_above_what_is_expected_is_and_matters(
    after, tolerance, left
):
    before, expected = errors(10.0, 10.0, 10.0), np.full(3, 1.6)  # and up to 2, as it may be off
    assert _leaves_most(SimpleNamespace(tolerance=tolerance), before, errors(*after), expected) is left


@pytest.mark.parametrize(
    ("windows", "whole", "left"), [(2.9, 10.9, False), (2.9, 11.1, True), (3.1, 6.1, True)]
)
def test_where_windows_err_as_expected_a_longer_simulation_may_err_as_much_as_before(windows, whole, left):
    before, expected = errors(10.0, 10.0, 10.0), np.full(3, 1.6)  # and up to 2, as it may be off
    after = errors(2.0, windows, whole)
    assert _leaves_most(SimpleNamespace(tolerance=1.0), before, after, expected) is left


@pytest.mark.parametrize(("viscous", "told"), [(0.0, "to 0: these recordings"), (0.0011, None)])
def test_a_number_that_a_fit_moved_to_nothing_is_told(viscous, told):
    problem = SimpleNamespace(
        plant=GIVEN, scale=SimpleNamespace(torque=0.1, speed=10.0, current=0.5, recordings=())
    )
    said = [
        words for words in at_bounds(problem, GIVEN.with_values({VISCOUS: viscous})) if "viscous" in words
    ]
    assert len(said) == (1 if told else 0)
    assert all(told in words for words in said)
