"""What is left of a structure once an effect is taken out of it."""

from types import SimpleNamespace

import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.search.settled import Settled, simpler
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import plant_from_config

PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
BODY = Slot(BASE_OWNER, "inertia")


def beside(plant, *effect_ids):
    """`plant` with these effects at their first starts."""
    for effect_id in effect_ids:
        parameters = plant.layout.effect(effect_id).parameters
        plant = plant.with_effect(effect_id, {p.symbol: p.starts[0] * p.si for p in parameters})
    return plant


@pytest.mark.parametrize("effect_id", ["backlash", "shaft_compliance"])
def test_the_body_carries_the_load_of_a_gap_or_a_shaft_that_goes(effect_id):
    plant = beside(PLAIN, effect_id)
    total = plant.values[BODY] + plant.values[Slot(effect_id, "load_inertia")]
    assert simpler(plant, effect_id, PLAIN).values[BODY] == pytest.approx(total)


def test_the_body_stays_as_it_is_where_no_load_goes():
    assert simpler(beside(PLAIN, "stiction"), "stiction", PLAIN).values[BODY] == PLAIN.values[BODY]


class Costs:
    """Fits whose plants cost so much as they stand, and that count what they settle."""

    def __init__(self, cost):
        self.problem = SimpleNamespace(plant=PLAIN)
        self.settled_cost = lambda *_: cost
        self.asked = 0

    def abreast(self, function, items):
        return [function(item) for item in items]

    def settled(self, plant, _):
        self.asked += 1
        return structure(plant, -10.0)


def structure(plant, cost):
    return SimpleNamespace(plant=plant, fitted_cost=cost, fitted=SimpleNamespace(cost=cost), noise=None)


@pytest.mark.parametrize(
    ("effects", "cost", "asked"),
    [
        (("backlash",), 61.0, 0),  # far behind: no fit would bring it near
        (("backlash",), 59.0, 1),
        (("backlash", "shaft_compliance"), 61.0, 1),  # with a second body left, its cost says nothing
    ],
)
def test_what_costs_far_more_is_not_settled_again_unless_a_second_body_stays(effects, cost, asked):
    fits = Costs(cost)
    kept = Settled(fits, structure(beside(PLAIN, *effects[:-1]), 0.0))
    kept.without(structure(beside(PLAIN, *effects), -99.0), effects[-1])
    assert fits.asked == asked


def test_what_was_settled_once_from_a_structure_is_not_settled_again():
    fits = Costs(0.0)
    kept = Settled(fits, structure(PLAIN, -50.0))
    best = structure(beside(PLAIN, "stiction"), -99.0)
    assert [kept.without(best, "stiction").fitted_cost for _ in range(2)] == [-50.0, -50.0]
    assert fits.asked == 1
