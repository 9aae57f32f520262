"""Parameters that a re-fit moved tenfold, or to nothing."""

import numpy as np
import pytest

import nxt_twin as nt
from nxt_twin.diagnose.fitting.tamed import tamed
from nxt_twin.diagnose.telling.far import moved_far

GIVEN = nt.load_plant("nxt_motor")


def refitted(**times):
    """The plant with some keys multiplied."""
    keys = GIVEN.to_config()
    return nt.load_plant({**keys, **{name: keys[name] * factor for name, factor in times.items()}})


@pytest.mark.parametrize(
    ("times", "parts"),
    [
        ({"inertia_kg_m2": 12.0}, ["inertia_kg_m2 to 0.0144 kg·m², 12 times the given 0.0012"]),
        ({"coulomb_friction_nm": 0.0}, ["coulomb_friction_nm to 0 N·m, none of the given 0.00845"]),
        ({"inertia_kg_m2": 0.05, "viscous_friction_nm_s_per_rad": 20.0}, ["0.05 times", " and ", "20 times"]),
    ],
)
def test_the_answer_begins_with_a_quantity_that_vanished_or_grew_tenfold(times, parts):
    (said,) = moved_far(GIVEN, refitted(**times))
    assert said.startswith("The re-fit moved ")
    for part in parts:
        assert part in said


def test_nothing_is_said_of_smaller_moves_or_of_effects_that_replace_a_key():
    assert moved_far(GIVEN, refitted(inertia_kg_m2=9.0, coulomb_friction_nm=0.11)) == ()
    assert moved_far(GIVEN, GIVEN.without(["coulomb_friction"])) == ()


def test_the_squares_of_a_simulation_that_ran_away_are_numbers():
    wild = tamed(np.array([np.inf, -1e200, np.nan, 2.0]))
    assert np.isfinite(wild @ wild)
    np.testing.assert_array_equal(wild[2:], [0.0, 2.0])
    assert wild[0] > 0.0 > wild[1]
