"""How sure the parameters are said to be."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose_motors import clean_case, settled

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.intervals import robust_covariance
from nxt_twin.diagnose.linear import linearise
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
    plain = np.linalg.inv(linear.slopes @ linear.slopes.T + np.diag(linear.tightness)) * np.outer(
        scale, scale
    )
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
