"""Each limit of a robot's powers and residual, from just below and just above it."""

from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.diagnose.robot import powered_fit, powered_search
from nxt_twin.diagnose.robot.choice import WeighedSubsets
from nxt_twin.diagnose.robot.leftover import RobotLeft
from nxt_twin.diagnose.robot.moved_motors import moved_motors
from nxt_twin.diagnose.robot.powered_fit import PoweredFit, Ruler, _Point, _Problem
from nxt_twin.diagnose.robot.powered_search import (
    PLACES,
    _matters,
    _surer,
    _that_matter,
    _to_refit,
    sizes_that_matter,
)
from nxt_twin.physics.robot.dynamics import NAMES

JUST_BELOW, JUST_ABOVE = 0.98, 1.02
EDGES = [(JUST_BELOW, False), (JUST_ABOVE, True)]
COUNT = len(NAMES)
FIT = PoweredFit(
    np.ones(COUNT),
    np.zeros(COUNT),
    np.ones(COUNT, dtype=bool),
    np.zeros((COUNT, COUNT)),
    24,
    1.0,
    Ruler(1.0, 4.0),
)


def fit_with(place, off, std):
    covariance = FIT.covariance.copy()
    covariance[place, place] = std**2
    return replace(FIT, off=np.where(np.arange(COUNT) == place, off, 0.0), covariance=covariance)


@pytest.mark.parametrize(("share", "matters"), EDGES)
@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("caster_drag", 0.05),
        ("floor_slope", 5e-3),
        ("centre_of_mass_offset", 3e-3),
        ("payload_mass", 0.05),
        ("battery_sag", 0.2),
        ("left_motor.asymmetric_friction", 2e-3),
        ("right_motor.asymmetric_friction", 2e-3),
        ("left_motor.quadratic_drag", 3e-4),
        ("right_motor.quadratic_drag", 3e-4),
        ("left_motor.voltage_drop", 0.25),
        ("right_motor.voltage_drop", 0.25),
    ],
)
def test_an_effect_of_the_powers_matters_from_its_size_on(name, least, share, matters):
    off = np.zeros(len(PLACES[name]))
    off[0] = share * least
    assert _matters(name, off) == matters
    assert sizes_that_matter()[PLACES[name]] == pytest.approx(least)


@pytest.mark.parametrize(("share", "kept"), EDGES)
def test_a_size_has_to_matter_one_and_a_half_standard_deviations_nearer_to_nothing(share, kept, monkeypatch):
    (place,) = PLACES["payload_mass"]
    fitted = fit_with(place, 0.05 + 1.5 * share * 0.02, 0.02)
    monkeypatch.setattr(powered_search, "fit_powered", lambda *_: fitted)
    monkeypatch.setattr(powered_search, "_evidence", lambda *_: 1.0)
    ids, _ = _that_matter(frozenset({"payload_mass"}), FIT, None, FIT.values, {})
    assert (ids == {"payload_mass"}) == kept


@pytest.mark.parametrize(("share", "goes_on"), EDGES)
def test_a_fit_goes_on_while_a_step_may_gain_a_fiftieth_of_a_nat(share, goes_on, monkeypatch):
    # Half of the summed squares, of which four rows count as one, is what the step takes away.
    rows, free = 100, np.arange(COUNT) == NAMES.index("added_mass")
    error = np.full((rows, 2), np.sqrt(share * 0.02 * 2.0 * 4.0 / (2 * rows)))
    monkeypatch.setattr(powered_fit, "_projected", lambda *_: (0.0 * error, None))
    at = _Point(np.zeros(COUNT), error, np.full((rows, 2, 1), 1e3))
    problem = _Problem(None, np.ones(COUNT), free, np.zeros(rows, dtype=int))
    assert (problem.lower(at, Ruler(1.0, 4.0), 0) is not None) == goes_on


@pytest.mark.parametrize(("share", "kept"), EDGES)
def test_an_effect_that_is_fitted_by_itself_needs_six_nats_beyond_the_size_that_matters(
    share, kept, monkeypatch
):
    # 24 windows: the nats of a squared distance d are 12 log(1 + d / 23).
    distance = np.sqrt(23.0 * (np.exp(share * 6.0 / 12.0) - 1.0))
    (place,) = PLACES["payload_mass"]
    fitted = fit_with(place, 0.05 + distance * 0.02, 0.02)
    monkeypatch.setattr(powered_search, "fit_powered", lambda *_: fitted)
    ids, _ = _that_matter(frozenset({"payload_mass"}), FIT, None, FIT.values, {})
    assert (ids == {"payload_mass"}) == kept


@pytest.mark.parametrize(("behind", "tried"), [(9.8, True), (10.2, False)])
def test_rivals_less_than_ten_nats_behind_are_fitted_by_themselves(behind, tried):
    best, rival = frozenset({"payload_mass"}), frozenset({"caster_drag"})
    assert (rival in _to_refit(WeighedSubsets(best, {}, {}, ((rival, behind),)))) == tried


def test_two_rivals_are_fitted_beside_the_best_and_what_has_one_effect_less():
    best = frozenset({"payload_mass", "caster_drag"})
    rivals = [frozenset({one}) for one in ("floor_slope", "battery_sag", "centre_of_mass_offset")]
    tried = _to_refit(WeighedSubsets(best, {}, {}, tuple((one, 1.0) for one in rivals)))
    assert tried == [best, {"payload_mass"}, {"caster_drag"}, *rivals[:2]]


def test_an_effect_that_refits_chose_is_at_least_as_likely_as_not():
    assert [_surer(one) for one in (0.1, 0.49, 0.51, 0.9)] == [0.5, 0.5, 0.51, 0.9]


@pytest.mark.parametrize(("share", "structured"), EDGES)
@pytest.mark.parametrize(("channel", "least"), [("along", 1e-4), ("sideways", 1e-4), ("turn", 5e-4)])
def test_a_residual_is_physics_from_a_tenth_of_a_millimetre_or_half_a_milliradian_a_second_on(
    channel, least, share, structured
):
    assert RobotLeft("speed", channel, 20.0, 0.5, share * least).is_structured == structured


@pytest.mark.parametrize(("share", "told"), EDGES)
@pytest.mark.parametrize(("std", "least"), [(0.01, 0.3), (0.15, 0.45)])
def test_a_motors_number_is_told_as_moved_beyond_what_motors_differ_by_and_beyond_doubt(
    std, least, share, told
):
    place = NAMES.index("left_coulomb")
    moved = moved_motors(FIT.values, fit_with(place, share * least, std))
    assert (list(moved) == ["left_motor.coulomb_friction_nm"]) == told
