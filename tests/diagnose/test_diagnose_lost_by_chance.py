"""Counts that are lost beside other effects have to bring simulations nearer, as what is lost on average does."""

from types import SimpleNamespace

import pytest
from diagnose_limits import effect_named, structure

from nxt_twin.diagnose.search.standard import Standard
from nxt_twin.diagnose.search.weight import Weight
from nxt_twin.physics.library import library

LOST = library()["missed_counts"]


def worth_it(effect, ratio, *found):
    problem = SimpleNamespace(tolerance=1.0, by_windows=False, leaning={})
    standard = Standard(SimpleNamespace(problem=problem), structure(), SimpleNamespace())
    best = structure(*found, error=2.0)
    best.plant.effects = ()
    return standard.worth_it(effect, Weight(800.0, 300.0, ratio, runs_worse=False), best)


@pytest.mark.parametrize(("ratio", "told"), [(0.64, True), (0.66, False)])
def test_lost_counts_beside_another_effect_bring_simulations_nearer(ratio, told):
    assert worth_it(LOST, ratio, "power_curve") is told


def test_alone_or_of_another_effect_no_nearer_simulation_is_asked():
    assert worth_it(LOST, 0.9)
    assert worth_it(effect_named("drag"), 0.9, "power_curve")
