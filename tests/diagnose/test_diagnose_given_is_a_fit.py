"""Whether given numbers were fitted to readings like the recorded ones."""

from types import SimpleNamespace

import numpy as np
import pytest

import nxt_twin as nt
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.rivals import Rival
from nxt_twin.diagnose.search.searched import _is_a_fit, _without
from nxt_twin.physics.layout import BASE_OWNER, Slot

GIVEN = nt.load_plant("nxt_motor")
BEST, LIKELY = (GIVEN.with_values({Slot(BASE_OWNER, "inertia"): kg_m2}) for kg_m2 in (2e-3, 3e-3))


class Fits:
    """Fits of a problem whose plants err as told; what is settled, is as it was."""

    def __init__(self, errors=()):
        self.problem = SimpleNamespace(plant=GIVEN)
        self._errors = dict(errors)

    def simulated_error(self, plant, _noise):
        return self._errors[id(plant)]

    def settled(self, plant, _noise):
        return structure(plant)


def structure(plant, cost=0.0):
    """What a weight needs of a structure."""
    fitted = SimpleNamespace(variables=(), readings=100, prior_cost=0.0)
    return SimpleNamespace(
        plant=plant,
        noise=None,
        fitted=fitted,
        fitted_cost=cost,
        check_cost=cost,
        window_errors=(np.ones(3), np.ones(3)),
        believed=100.0,
        slight=0.0,
    )


@pytest.mark.parametrize(
    ("best", "likely", "is_a_fit"), [(0.99, 1.03, True), (0.99, 1.01, False), (0.97, 1.03, False)]
)
def test_given_numbers_are_a_fit_where_no_re_fit_comes_as_near(best, likely, is_a_fit):
    fits = Fits({id(GIVEN): 1.0, id(BEST): best, id(LIKELY): likely})
    assert _is_a_fit(fits, structure(LIKELY), structure(BEST)) is is_a_fit


def test_what_would_do_in_the_place_of_an_effect_that_goes_is_looked_at_again():
    gone, instead = GIVEN.layout.effect("hanging_payload"), GIVEN.layout.effect("load_dependent_friction")
    with_gone = GIVEN.with_effect(gone.id, {p.symbol: p.starts[0] * p.si for p in gone.parameters})
    with_instead = structure(GIVEN.with_effect(instead.id, {"per_torque": 0.3}), cost=-20.0)
    explanation = Explanation(
        structure(GIVEN),
        structure(with_gone),
        ((gone, None),),
        {gone.id: (Rival(instead, 3.0, with_instead, simulates_worse=False),)},
        (("earlier", None, None),),
    )
    lesser = _without(Fits(), explanation, gone)
    assert (lesser.found, lesser.rivals) == ((), {})
    (effect, weight, trial), earlier = lesser.refused
    assert (effect, trial, earlier[0]) == (instead, with_instead, "earlier")
    assert weight.gain == weight.check_gain == 20.0
