"""What speaks for a structure over a simpler one, and the units in which errors are told."""

import math
from dataclasses import FrozenInstanceError
from types import SimpleNamespace

import numpy as np
import pytest

from nxt_twin.diagnose.search.weight import Weight, free_run_ratio, weigh
from nxt_twin.diagnose.units import units_of
from nxt_twin.physics.effects.friction import LOAD_DEPENDENT_FRICTION
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.recording.configs import load_plant_config

MOTOR = plant_from_config(load_plant_config("nxt_motor"), "power_pct")
READINGS = 1000


def windows(errors):
    """Two windows of each kind of run, about errors so large."""
    return tuple(np.array([0.5 * error, 2.0 * error, np.nan]) for error in errors)


def structure(*, cost, variables=7, plant=MOTOR, check_cost=100.0, prior_cost=0.0):
    """A fitted structure as `weigh` reads one; `cost` is with its priors'."""
    fitted = SimpleNamespace(variables=[None] * variables, readings=READINGS, prior_cost=prior_cost)
    return SimpleNamespace(
        fitted=fitted,
        fitted_cost=cost,
        check_cost=check_cost,
        window_errors=windows((1.0, 1.0)),
        believed=READINGS,
        plant=plant,
        slight=0.0,
    )


@pytest.mark.parametrize("further", [0, 1, 3, 9])
def test_each_further_parameter_costs_half_a_logarithm_of_the_readings(further):
    gain = weigh(structure(cost=200.0), structure(cost=150.0, variables=7 + further)).gain
    assert gain == pytest.approx(50.0 - 0.5 * further * math.log(READINGS))


def test_a_share_of_faulty_readings_costs_as_much_as_a_parameter():
    stale = MOTOR.adding("stale_samples", stale_fraction=0.05)
    gain = weigh(structure(cost=200.0), structure(cost=150.0, plant=stale)).gain
    assert gain == pytest.approx(50.0 - 0.5 * math.log(READINGS))


@pytest.mark.parametrize(("readings", "counted"), [(1, 2), (2, 2), (3, 3)])
def test_a_parameter_costs_something_however_few_readings_there_are(readings, counted):
    richer = structure(cost=150.0, variables=8)
    richer.fitted.readings = readings
    assert weigh(structure(cost=200.0), richer).gain == pytest.approx(50.0 - 0.5 * math.log(counted))


def test_what_a_parameter_gains_by_chance_does_not_pay_for_it():
    """Noise gives half a nat for each parameter; the penalty is seven times that for a thousand readings."""
    assert weigh(structure(cost=200.0), structure(cost=199.5, variables=8)).gain < -2.5


@pytest.mark.parametrize(
    ("frame", "kind", "is_speed", "unit", "factor"),
    [
        ("linear", "force_n", False, "mm", 1000.0),
        ("linear", "force_n", True, "mm/s", 1000.0),
        ("motor", "power_pct", False, "deg", 180.0 / math.pi),
        ("rotary", "torque_nm", True, "deg/s", 180.0 / math.pi),
    ],
)
def test_errors_are_told_in_millimetres_or_degrees(frame, kind, is_speed, unit, factor):
    units = units_of(frame, SimpleNamespace(input_kind=kind, is_speed=is_speed))
    assert (units.reading, units.reading_factor) == (unit, pytest.approx(factor))


@pytest.mark.parametrize(("drive", "load"), [(0.3, 0.1), (0.1, -0.3), (-0.3, 0.3)])
def test_friction_grows_with_the_larger_of_drive_and_load_and_not_with_their_sum(drive, load):
    friction = LOAD_DEPENDENT_FRICTION.terms["friction"]
    assert friction(0.02, drive, load, 0.2) == pytest.approx(0.02 + 0.2 * 0.3)


def weighed(*, runs=(1.0, 1.0), check=0.0, plant=MOTOR, believed=READINGS, restored=0.0):
    """A richer structure whose two free runs err by these ratios, with so much more likelihood on check readings."""
    simpler = structure(cost=200.0, check_cost=100.0, prior_cost=restored)
    richer = structure(cost=150.0, variables=8, check_cost=100.0 - check, plant=plant)
    richer.window_errors, simpler.believed = windows(runs), believed
    return weigh(simpler, richer)


def test_gains_in_likelihood_add_up():
    weight = weighed(check=12.0)
    assert weight.check_gain == pytest.approx(12.0)
    assert weight.total == pytest.approx(weight.gain + 12.0)


@pytest.mark.parametrize("runs", [(0.4, 1.5), (1.5, 0.4)])
def test_the_kinder_of_the_two_free_runs_counts(runs):
    assert weighed(runs=runs).free_run_ratio == pytest.approx(0.4)
    simpler, richer = structure(cost=200.0), structure(cost=150.0)
    richer.window_errors = windows(runs)
    assert free_run_ratio(simpler, richer) == pytest.approx(0.4)


SECOND_BODY = {"backlash": {"gap_deg": 5.0, "load_inertia_kg_m2": 5e-4}}


@pytest.mark.parametrize(
    ("ratio", "check", "added", "worse"),
    [
        (1.009, 0.0, {}, False),
        (1.011, 0.0, {}, True),
        (1.049, 41.0, {}, False),
        (1.051, 41.0, {}, True),
        (1.02, 39.0, {}, True),
        (1.02, 40.0, {}, True),
        (1.14, 10.1, SECOND_BODY, False),
        (1.16, 10.1, SECOND_BODY, True),
        (1.14, 10.0, SECOND_BODY, True),
        (1.14, 10.1, {"constant_load": {"load_torque_nm": 0.01}}, True),
        (1.09, 0.0, {"stale_samples": {"stale_fraction": 0.05}}, False),
        (1.11, 0.0, {"stale_samples": {"stale_fraction": 0.05}}, True),
    ],
)
def test_free_runs_that_come_out_worse_speak_against_it(ratio, check, added, worse):
    plant = MOTOR
    for effect, parameters in added.items():
        plant = plant.adding(effect, **parameters)
    assert weighed(runs=(ratio, ratio), check=check, plant=plant).runs_worse == worse


@pytest.mark.parametrize(
    ("runs", "check", "worse"),
    [((0.9, 2.49), 0.0, False), ((0.9, 2.5), 0.0, True), ((0.4, 2.6), 41.0, False), ((0.6, 2.6), 41.0, True)],
)
def test_one_kind_of_run_much_worse_speaks_against_it_unless_readings_are_sure(runs, check, worse):
    assert weighed(runs=runs, check=check).runs_worse == worse


@pytest.mark.parametrize(("slight", "worse"), [(0.0, True), (0.01, False)])
def test_windows_at_rest_do_not_outweigh_those_in_which_a_motor_moves(slight, worse):
    """Ten windows at rest err by thousandths more, and two in motion by a third of what they did."""
    simpler, richer = structure(cost=200.0), structure(cost=150.0)
    simpler.slight = slight
    simpler.window_errors = (np.array([1e-3] * 10 + [3.0, 6.0]),) * 2
    richer.window_errors = (np.array([3e-3] * 10 + [1.0, 2.0]),) * 2
    assert weigh(simpler, richer).runs_worse is worse


@pytest.mark.parametrize(
    ("growth", "check", "worse"), [(0.09, 41.0, False), (0.11, 41.0, True), (0.09, 39.0, True)]
)
def test_free_runs_that_grow_by_next_to_nothing_do_not_outweigh_sure_readings(growth, check, worse):
    simpler, richer = structure(cost=200.0), structure(cost=150.0, check_cost=100.0 - check)
    simpler.slight = 0.1
    simpler.window_errors = (np.array([0.1, 0.1]),) * 2
    richer.window_errors = (np.array([0.1, 0.1 + 0.2 * growth]),) * 2
    assert weigh(simpler, richer).runs_worse is worse


def test_free_runs_of_a_plant_that_takes_what_it_cannot_explain_for_faults_tell_nothing():
    assert not weighed(runs=(3.0, 3.0), believed=int(0.96 * READINGS)).runs_worse
    for believed in (0.97, 0.98):
        assert weighed(runs=(3.0, 3.0), believed=int(believed * READINGS)).runs_worse


@pytest.mark.parametrize(
    ("ratio", "check", "borne_out"),
    [
        (1.0, 5.1, True),
        (1.0, 4.9, False),
        (0.49, -2.9, True),
        (0.51, -2.9, False),
        (0.49, -4.2, True),  # a tenth of what the fitted readings gain
        (0.49, -5.0, False),
    ],
)
def test_readings_that_were_not_fitted_bear_it_out_by_likelihood_or_much_nearer_runs(ratio, check, borne_out):
    assert weighed(runs=(ratio, ratio), check=check).borne_out(5.0) == borne_out


@pytest.mark.parametrize(
    ("ratio", "check", "borne_out"),
    [(1.0, 5.0, False), (0.49, -2.9, True), (0.49, -3.0, False), (0.5, -2.9, False)],
)
def test_where_little_is_gained_three_nats_are_enough_to_deny_it(ratio, check, borne_out):
    assert Weight(10.0, check, ratio, runs_worse=False).borne_out(5.0) == borne_out


@pytest.mark.parametrize(
    ("restored", "check", "borne_out"),
    [(10.1, -2.9, True), (9.9, -2.9, False), (10.1, -4.2, True), (10.1, -5.0, False)],
)
def test_what_brings_given_numbers_back_need_not_be_borne_out_by_readings(restored, check, borne_out):
    assert weighed(restored=restored, check=check).borne_out(5.0) == borne_out


@pytest.mark.parametrize(
    ("restored", "ratio", "worse"), [(10.1, 1.04, False), (10.1, 1.06, True), (9.9, 1.04, True)]
)
def test_what_brings_given_numbers_back_may_run_a_little_worse(restored, ratio, worse):
    assert weighed(restored=restored, runs=(ratio, ratio)).runs_worse == worse


def test_a_weight_never_changes():
    with pytest.raises(FrozenInstanceError):
        Weight(10.0, 0.0, 1.0, runs_worse=False).gain = 20.0


def test_structures_of_which_one_was_run_in_fewer_ways_are_not_compared():
    richer = structure(cost=150.0)
    richer.window_errors = richer.window_errors[:1]
    with pytest.raises(ValueError, match="zip"):
        weigh(structure(cost=200.0), richer)
