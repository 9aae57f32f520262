"""What a change has to gain to stay: by its size, and by what stands beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.blind.case import NOMINAL
from nxt_twin.diagnose.changed.engine import is_seen_closer
from nxt_twin.diagnose.changed.joint import JointFit
from nxt_twin.diagnose.changed.model import all_shared
from nxt_twin.diagnose.changed.weighing import Weighing
from nxt_twin.diagnose.changed.words import unchanged_words
from nxt_twin.diagnose.diagnosis import Fit
from nxt_twin.physics.parameter import NXT_SCALE
from nxt_twin.physics.plant import plant_from_config

LIMIT = 5.0
WEIGHING = Weighing(2.0, LIMIT, 0.0, NXT_SCALE)


def fit_with(differs, effects=(), cost=0.0, check_rms=(0.01, 0.01), check_cost=0.0):
    """A fit in which parameters differ by factors, and effects have sizes (SI, by symbol)."""
    model = all_shared(plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct"), NXT_SCALE)
    ways = {way.slot.symbol: n for n, way in enumerate(model.ways)}
    model = model.differing([ways[symbol] for symbol in differs])
    for effect, values in dict(effects).items():
        model = model.with_effect(effect, values, NXT_SCALE)
    x = model.start()
    for place, n in enumerate(model.differs, start=len(model.shared)):
        x[place] = math.log(differs[model.ways[n].slot.symbol])
    return JointFit(model, x, 0.01, cost, check_cost, check_rms), ways


@pytest.mark.parametrize(
    ("factor", "needs"), [(1.25, 20.0), (1.0 / 1.25, 20.0), (1.32, LIMIT), (2.0, LIMIT)], ids=str
)
def test_a_slight_parameter_alone_needs_more(factor, needs):
    joint, ways = fit_with({"viscous": factor})
    assert WEIGHING.keeping(joint, ways["viscous"]) == needs


@pytest.mark.parametrize("friction", ["viscous", "coulomb"])
@pytest.mark.parametrize(
    ("factor", "needs"), [(1.04, math.inf), (1.0 / 1.04, math.inf), (1.06, 20.0)], ids=str
)
def test_friction_that_differs_as_from_run_to_run_is_no_change(friction, factor, needs):
    joint, ways = fit_with({friction: factor})
    assert WEIGHING.keeping(joint, ways[friction]) == needs


def test_what_is_no_friction_may_differ_by_less():
    joint, ways = fit_with({"inertia": 1.04})
    assert WEIGHING.keeping(joint, ways["inertia"]) == 20.0


@pytest.mark.parametrize(("factor", "needs"), [(1.25, LIMIT + 15.0), (1.32, LIMIT)], ids=str)
def test_a_slight_parameter_beside_another_change_needs_more_still(factor, needs):
    joint, ways = fit_with({"viscous": factor, "coulomb": 3.0})
    assert WEIGHING.keeping(joint, ways["viscous"]) == needs
    assert WEIGHING.keeping(joint, ways["coulomb"]) == LIMIT


@pytest.mark.parametrize(("load_nm", "needs"), [(0.0006, math.inf), (0.02, LIMIT)], ids=str)
def test_an_effect_too_small_to_have_a_name_is_no_change(load_nm, needs):
    joint, _ = fit_with({"coulomb": 3.0}, {"constant_load": {"load": load_nm}})
    assert WEIGHING.keeping(joint, "constant_load") == needs
    alone, _ = fit_with({}, {"constant_load": {"load": load_nm}})
    assert WEIGHING.keeping(alone, "constant_load") == needs


@pytest.mark.parametrize(("factor", "needs"), [(1.25, math.inf), (1.32, LIMIT)], ids=str)
def test_what_is_slight_is_no_change_where_one_plant_predicts_both_sides(factor, needs):
    joint, ways = fit_with({"viscous": factor})
    assert replace(WEIGHING, within=True).keeping(joint, ways["viscous"]) == needs


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


def test_each_change_more_has_to_gain_what_a_change_has_to_gain():
    one, _ = fit_with({"coulomb": 3.0})
    two, _ = fit_with({"coulomb": 3.0, "viscous": 2.0}, cost=-8.0)
    assert WEIGHING.net(one, two) == pytest.approx(8.0 - 2.0)
    assert WEIGHING.worth(one, two) == pytest.approx(8.0 - 2.0 - LIMIT)


def test_an_arm_that_came_in_is_one_change_with_its_inertia():
    arm = {"gravity_load": {"gravity": 0.05, "phase": 0.3}}
    bare, _ = fit_with({}, arm)
    with_inertia, _ = fit_with({"inertia": 1.5}, arm, cost=-8.0)
    assert WEIGHING.worth(bare, with_inertia) == pytest.approx(8.0 - 2.0)


def test_inertia_beside_a_new_arm_needs_little_and_has_no_rivals():
    arm = {"gravity_load": {"gravity": 0.05, "phase": 0.3}}
    joint, ways = fit_with({"inertia": 1.5}, arm)
    assert WEIGHING.is_companion(joint, ways["inertia"])
    assert WEIGHING.keeping(joint, ways["inertia"]) == 1.0
    alone, ways = fit_with({"inertia": 1.5})
    assert not WEIGHING.is_companion(alone, ways["inertia"])
    assert WEIGHING.keeping(alone, ways["inertia"]) == LIMIT


@pytest.mark.parametrize(
    ("gain", "rms_after", "matters"),
    [(10.0, 0.0094, True), (10.0, 0.0096, False), (21.0, 0.01, False), (23.0, 0.01, True)],
)
def test_changes_that_bring_no_window_nearer_need_more(gain, rms_after, matters):
    simpler, _ = fit_with({}, check_rms=(0.0, 0.01))
    wider, _ = fit_with({"viscous": 1.2}, cost=-gain, check_rms=(0.0, rms_after))
    assert WEIGHING.matters(simpler, wider) == matters


@pytest.mark.parametrize(("gain", "loud"), [(26.0, False), (28.0, True)])
def test_one_of_many_numbers_of_cycles_has_to_gain_20_nats_more(gain, loud):
    simpler, _ = fit_with({})
    wider, _ = fit_with({"viscous": 1.2}, cost=-gain)
    assert WEIGHING.is_loud(simpler, wider) == loud


@pytest.mark.parametrize(
    ("check_cost", "rms_after", "lasts"),
    [(-1.0, 0.0101, True), (-1.0, 0.0103, False), (80.0, 0.0051, False), (80.0, 0.0049, True)],
)
def test_windows_that_only_check_accept_what_is_likelier_or_far_nearer(check_cost, rms_after, lasts):
    simpler, _ = fit_with({}, check_rms=(0.0, 0.01))
    wider, _ = fit_with({"viscous": 1.2}, check_rms=(0.0, rms_after), check_cost=check_cost)
    assert WEIGHING.lasts(simpler, wider) == lasts


@pytest.mark.parametrize(
    ("error_before", "beginning"),
    [
        (0.4, "No change is shown between a and b, yet"),
        (0.0, "No change is shown"),
        (0.6, "Nothing"),
        (None, "Nothing"),
    ],
)
def test_no_model_is_said_to_predict_both_sides_that_errs_twice_as_much_after(error_before, beginning):
    fit = Fit("windows", "deg", 1.0, 1.0, 1.0)
    assert unchanged_words("a", "b", fit, error_before).startswith(beginning)


@pytest.mark.parametrize(
    ("differs", "effects", "counts"),
    [
        ({}, {}, False),
        ({"viscous": 1.2}, {}, True),
        ({}, {"command_delay": {"delay": 0.01}}, True),
        ({"torque_constant": 1.2}, {}, False),
        ({}, {"stiction": {"breakaway": 0.03, "stribeck": 1.0}}, False),
    ],
    ids=str,
)
def test_close_windows_tell_slight_parameters_and_delays_alone(differs, effects, counts):
    joint, _ = fit_with(differs, effects)
    assert is_seen_closer(joint.model) == counts
