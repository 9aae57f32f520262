"""How sure the parameters are said to be."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import clean_case, recorded, settled

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.braking import braked_alike
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.judging.intervals import _at_bounds, robust_covariance
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator


@pytest.fixture(scope="module")
def fitted():
    case = clean_case(41)
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, final = settled(simulator, case)
        yield simulator, linearise(simulator, problem, final)


def stds(covariance):
    return np.sqrt(np.diag(covariance))


def test_no_direction_is_surer_than_by_the_plain_covariance(fitted):
    simulator, linear = fitted
    scale = np.array([v.scale for v in linear.variables])
    plain = np.linalg.inv(linear.slopes @ linear.slopes.T + np.diag(linear.tightness))
    plain *= np.outer(scale, scale)
    robust = robust_covariance(simulator, linear)
    assert np.allclose(robust, robust.T)
    assert (stds(robust) >= 0.999 * stds(plain)).all()


def test_innovations_that_hang_together_widen_what_the_readings_alone_decide(fitted):
    simulator, linear = fitted
    rng = np.random.default_rng(2)
    white = rng.normal(size=linear.innovations.size)
    slow = np.convolve(rng.normal(size=white.size + 59), np.ones(60) / np.sqrt(60.0), mode="valid")
    free = replace(linear, tightness=np.zeros_like(linear.tightness))
    narrow = stds(robust_covariance(simulator, replace(free, innovations=white)))
    wide = stds(robust_covariance(simulator, replace(free, innovations=slow)))
    assert np.median(wide / narrow) > 1.3


def test_the_doubt_about_the_supply_bounds_how_sure_the_back_emf_can_be(fitted):
    simulator, linear = fitted
    place = next(n for n, v in enumerate(linear.variables) if v.slots[0].symbol == "torque_constant")
    value = linear.structure.plant.values[linear.variables[place].slots[0]]
    assert stds(robust_covariance(simulator, linear))[place] / value > 1e-3


def std_of(linear, covariance, symbol):
    place = next(n for n, v in enumerate(linear.variables) if v.slots[0].symbol == symbol)
    value = linear.structure.plant.values[linear.variables[place].slots[0]]
    return stds(covariance)[place], value


@pytest.fixture(scope="module")
def stopped():
    case = recorded(43, motor={"stop_side": 1.0, "stop_rad": 3.0})
    with Simulator(problem_for(case).plant.layout) as simulator:
        added = {"end_stop": {"limit": 2.9, "restitution": 0.4}}
        problem, _, final = settled(simulator, case, added=added)
        yield simulator, linearise(simulator, problem, final)


def test_hits_against_a_stop_tell_nothing_of_how_large_torques_are(fitted, stopped):
    for simulator, linear in (fitted, stopped):
        std, resistance = std_of(linear, robust_covariance(simulator, linear), "resistance")
        assert 0.07 < std / resistance < 0.15


def test_where_a_stop_stands_is_known_to_about_a_count(stopped):
    simulator, linear = stopped
    std, limit = std_of(linear, robust_covariance(simulator, linear), "limit")
    assert np.radians(0.4) < std < np.radians(2.0)
    assert abs(limit - 3.0) < 2.0 * std


def test_where_the_zero_of_the_encoder_lies_matters_to_nothing_that_turns_with_it(fitted):
    simulator, linear = fitted
    coarse = replace(
        linear, jobs=tuple(replace(job, signals=replace(job.signals, quantum=0.2)) for job in linear.jobs)
    )
    fine, rough = (robust_covariance(simulator, one) for one in (linear, coarse))
    assert np.allclose(stds(rough), stds(fine), rtol=1e-3)


def test_what_laws_of_one_name_leave_open_is_in_the_interval(fitted):
    simulator, linear = fitted
    place = next(n for n, v in enumerate(linear.variables) if v.slots[0].symbol == "coulomb")
    slot = linear.variables[place].slots[0]
    told = linear.structure.plant.layout.parameters
    before = stds(robust_covariance(simulator, linear))
    try:
        kept = told[slot]
        told[slot] = replace(kept, law=0.5)
        after = stds(robust_covariance(simulator, linear))
    finally:
        told[slot] = kept
    added = 0.5 * linear.structure.plant.values[slot]
    assert after[place] == pytest.approx(np.hypot(before[place], added), rel=1e-6)
    assert np.allclose(np.delete(after, place), np.delete(before, place))


@pytest.mark.parametrize(
    ("value", "first", "across"), [(2.0, 0.75, 0.0), (1.0, 0.75, 0.0), (1.5, 1.0, 0.5), (1.99, 1.0, 0.5)]
)
def test_what_rests_on_a_bound_leaves_nothing_open_of_the_others(value, first, across):
    """A size that goes with an exponent is as sure as that exponent lets it be; one on its bound lets it all."""
    bounds = SimpleNamespace(lower=1.0, upper=2.0, si=1.0)
    free = SimpleNamespace(lower=0.0, upper=9.0, si=1.0)
    parameters = {"size": free, "exponent": bounds}
    parameters = {k: SimpleNamespace(scaled=lambda _, own=own: own, si=1.0) for k, own in parameters.items()}
    plant = SimpleNamespace(
        layout=SimpleNamespace(parameters=parameters), values={"size": 3.0, "exponent": value}
    )
    linear = SimpleNamespace(
        structure=SimpleNamespace(plant=plant),
        variables=[SimpleNamespace(slots=("size",)), SimpleNamespace(slots=("exponent",))],
    )
    found = _at_bounds(SimpleNamespace(scale=None), linear, np.array([[1.0, 0.5], [0.5, 1.0]]))
    np.testing.assert_allclose(found, [[first, across], [across, 1.0]])


def test_hits_against_a_stop_do_not_tell_friction_from_the_braking_of_a_motors_own_voltage():
    """Along this direction nothing moves, so that priors alone know the torque constant."""
    case = recorded(45, motor={"stop_side": 1.0, "stop_rad": 2.0})
    with Simulator(problem_for(case).plant.layout) as simulator:
        added = {"end_stop": {"limit": 2.0, "restitution": 0.4}}
        problem, _, final = settled(simulator, case, added=added)
        linear = linearise(simulator, problem, final)
        std, constant = std_of(linear, robust_covariance(simulator, linear), "torque_constant")
    assert std / constant > 0.01


def test_the_friction_of_a_motor_that_brakes_alike_makes_up_for_its_voltage():
    plant = problem_for(clean_case(41)).plant
    slots = [Slot("base", "torque_constant"), Slot("base", "inertia"), Slot("viscous_friction", "viscous")]
    variables = [SimpleNamespace(slots=(slot,)) for slot in slots]
    constant, inertia, viscous = (plant.values[slot] for slot in slots)
    resistance = plant.values[Slot("base", "resistance")]

    def slowing(constant, inertia, viscous):
        return constant**2 / (resistance * inertia) + viscous / inertia

    size = 1e-4
    more = np.array([constant, inertia, viscous]) + size * braked_alike(plant, variables)
    assert slowing(*more) == pytest.approx(slowing(constant, inertia, viscous), rel=1e-7)
    assert more[0] / more[1] == pytest.approx(constant / inertia)
    assert not braked_alike(plant, variables[:2]).any()
