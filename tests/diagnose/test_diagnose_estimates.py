"""Parameters with their doubt, and what they rest on."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose_motors import recorded, settled

from nxt_twin.diagnose.diagnosis import Moved
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.linear import linearise
from nxt_twin.diagnose.judging.intervals import robust_covariance
from nxt_twin.diagnose.telling.estimates import ANCHORS, estimates, refitted, surely_moved
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.simulate import Simulator

ADDED = {"winding_heating": {"rise": 0.01, "thermal_time": 45.0}, "stale_samples": {"stale_fraction": 0.02}}


@pytest.fixture(scope="module")
def evidence():
    """As much of an `Evidence` as estimates look at, of a motor that warms, with the effects of `ADDED`."""
    case = recorded(41, motor={"resistance_rise_per_joule": 0.05, "thermal_time_s": 45.0})
    with Simulator(problem_for(case).plant.layout) as simulator:
        problem, _, final = settled(simulator, case, added=ADDED)
        covariance = robust_covariance(simulator, linearise(simulator, problem, final))
        yield SimpleNamespace(problem=problem, final=final, covariance=covariance)


def values(evidence, owner, *symbols):
    return [evidence.final.plant.values[Slot(owner, symbol)] for symbol in symbols]


def test_what_the_motion_does_not_fix_is_said_to_rest_on_what_was_given(evidence):
    moved = refitted(evidence)
    resting = {name for name, one in moved.items() if one.rests_on == ANCHORS}
    assert resting == set(moved) - {"torque_constant_nm_per_a", "back_emf_v_s_per_rad"}
    heating = estimates(evidence, evidence.problem.plant.layout.effect("winding_heating"))
    assert heating["resistance_rise_per_joule"].rests_on == ANCHORS
    assert heating["thermal_time_constant_s"].rests_on == ()


def test_ratios_are_what_the_motion_fixes_by_itself(evidence):
    resistance, inertia = values(evidence, "base", "resistance", "inertia")
    (rise,) = values(evidence, "winding_heating", "rise")
    viscous = refitted(evidence)["viscous_friction_nm_s_per_rad"].ratio
    assert viscous.value == pytest.approx(values(evidence, "viscous_friction", "viscous")[0] / inertia)
    heating = estimates(evidence, evidence.problem.plant.layout.effect("winding_heating"))
    ratio = heating["resistance_rise_per_joule"].ratio
    assert ratio.value == pytest.approx(rise / resistance)
    assert ratio.of == "resistance_ohm"


def test_ratios_are_surer_than_what_rests_on_the_given_resistance(evidence):
    coulomb = refitted(evidence)["coulomb_friction_nm"]
    assert coulomb.ratio.std / coulomb.ratio.value < 0.3 * coulomb.std / coulomb.after


def test_an_inductance_goes_with_the_resistance_and_keeps_the_doubt_that_it_was_given_with(evidence):
    moved = refitted(evidence)
    before, after = moved["resistance_ohm"], moved["inductance_h"]
    assert after.after / after.before == pytest.approx(before.after / before.before)
    assert after.std / after.after == pytest.approx(np.hypot(before.std / before.after, 0.15))


def test_a_share_is_counted_and_its_law_doubted(evidence):
    effect = evidence.problem.plant.layout.effect("stale_samples")
    found = estimates(evidence, effect)["stale_fraction"]
    fewer = replace(evidence.final, fitted=replace(evidence.final.fitted, readings=100))
    rough = estimates(SimpleNamespace(**{**vars(evidence), "final": fewer}), effect)["stale_fraction"]
    counted = found.value * (1.0 - found.value)
    law = effect.parameters[0].law * found.value
    assert found.std == pytest.approx(np.sqrt(counted / evidence.final.fitted.readings + law**2))
    assert rough.std == pytest.approx(np.sqrt(counted / 100 + law**2))


@pytest.mark.parametrize(
    ("interval", "by"),
    [((0.0, 1.9), 1.0), ((0.0, 0.25), 4.0), ((5.0, 9.0), 5.0), ((0.5, 2.0), 1.0), (None, 1.0)],
)
def test_a_number_surely_moved_by_the_near_end_of_its_interval(interval, by):
    assert surely_moved({"inertia_kg_m2": Moved(1.0, 0.1, 0.1, "", interval)}) == by


def test_a_number_given_as_nothing_has_moved_by_no_factor():
    assert surely_moved({"viscous_friction_nm_s_per_rad": Moved(0.0, 0.1, 0.1, "", (0.05, 0.2))}) == 1.0
