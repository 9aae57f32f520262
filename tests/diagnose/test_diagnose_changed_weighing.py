"""What a change has to gain to stay: by its size, and by what stands beside it."""

import math

import numpy as np
import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.changed.joint import JointFit
from nxt_twin.diagnose.changed.model import all_shared
from nxt_twin.diagnose.changed.weighing import Weighing
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.physics.plant import plant_from_config

LIMIT = 5.0
WEIGHING = Weighing(2.0, LIMIT, 0.0, NXT_SCALE)


def fit_with(differs, effects=()):
    """A fit in which parameters differ by factors, and effects have sizes (SI, by their main symbol)."""
    model = all_shared(plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct"), NXT_SCALE)
    ways = {way.slot.symbol: n for n, way in enumerate(model.ways)}
    model = model.differing([ways[symbol] for symbol in differs])
    for effect, values in dict(effects).items():
        model = model.with_effect(effect, values, NXT_SCALE)
    x = model.start()
    for place, n in enumerate(model.differs, start=len(model.shared)):
        x[place] = math.log(differs[model.ways[n].slot.symbol])
    return JointFit(model, x, 0.01, 0.0, 0.0, (0.01, 0.01)), ways


@pytest.mark.parametrize(
    ("factor", "needs"), [(1.07, 20.0), (1.0 / 1.07, 20.0), (1.1, LIMIT), (2.0, LIMIT)], ids=str
)
def test_a_slight_parameter_alone_needs_more(factor, needs):
    joint, ways = fit_with({"viscous": factor})
    assert WEIGHING.keeping(joint, ways["viscous"]) == needs


@pytest.mark.parametrize(("factor", "needs"), [(1.07, LIMIT + 15.0), (1.1, LIMIT)], ids=str)
def test_a_slight_parameter_beside_another_change_needs_more_still(factor, needs):
    joint, ways = fit_with({"viscous": factor, "coulomb": 3.0})
    assert WEIGHING.keeping(joint, ways["viscous"]) == needs
    assert WEIGHING.keeping(joint, ways["coulomb"]) == LIMIT


@pytest.mark.parametrize(("load_nm", "needs"), [(0.0006, LIMIT + 15.0), (0.02, LIMIT)], ids=str)
def test_an_effect_too_small_to_have_a_name_needs_more(load_nm, needs):
    joint, _ = fit_with({"coulomb": 3.0}, {"constant_load": {"load": load_nm}})
    assert WEIGHING.keeping(joint, "constant_load") == needs
    alone, _ = fit_with({}, {"constant_load": {"load": load_nm}})
    assert WEIGHING.keeping(alone, "constant_load") == (20.0 if needs > LIMIT else LIMIT)


@pytest.mark.parametrize(
    ("effect", "prior"),
    [({"constant_load": {"load": 0.02}}, 6.0), ({"missed_counts": {"loss": 0.05, "threshold": 5.0}}, 18.0)],
    ids=["brought in", "of the motor's make"],
)
def test_a_law_of_how_the_motor_is_made_costs_more_than_one_that_somebody_brings_in(effect, prior):
    bare, _ = fit_with({})
    with_it, _ = fit_with({}, effect)
    size = with_it.model.size - bare.model.size
    assert WEIGHING.plain(bare, with_it) == pytest.approx(-prior - 2.0 * size)
    assert np.isfinite(with_it.x).all()
