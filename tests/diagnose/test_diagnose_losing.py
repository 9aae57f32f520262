"""Counts that are lost beside a stop: the stop lies where readings end, and so moves with all that is lost."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.make import make_case
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.search.losing import further_away, lies_in_angle, losing
from nxt_twin.physics.further import turning_further
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import moving_start

LOSS = Slot("missed_counts", "loss")
PLAIN = plant_from_config({"kind": "dc_motor", **NOMINAL}, "power_pct")
AT_ANY_SPEED = 1e-6


@pytest.mark.parametrize(
    "effects",
    [
        {"end_stop": {"limit_deg": 200.0, "restitution": 0.4}},
        {"cogging": {"cogging_torque_nm": 0.02, "cycles_per_turn": 6.0, "phase_deg": 30.0}},
        {"quadratic_drag": {"quadratic_drag_nm_s2_per_rad2": 1e-4}},
    ],
)
def test_a_motor_that_turns_further_and_loses_as_much_reads_alike(effects):
    plant = plant_from_config({"kind": "dc_motor", **NOMINAL, "effects": effects}, "power_pct")
    lost = {"loss": 0.3, "threshold": AT_ANY_SPEED}
    further = turning_further(plant, 1.0 / 0.7, "power_pct").with_effect("missed_counts", lost)
    signals = problem_for(concealed((), seed=152)).signals[0]
    from_zero = replace(signals, measured=signals.measured - signals.measured[0])
    job = free_job(from_zero, moving_start(from_zero))
    with Simulator(plant.layout) as simulator:
        (own,), (turned,) = (
            simulator.run(*[each[None] for each in one.vectors()], [job]) for one in (plant, further)
        )
    assert np.ptp(own.predicted) > np.radians(100.0)
    assert turned.predicted == pytest.approx(own.predicted, abs=np.radians(1.0))


@pytest.mark.parametrize(
    ("effect", "lies"),
    [
        ("end_stop", True),
        ("backlash", True),
        ("cogging", True),
        ("quadratic_drag", False),
        ("inductance", False),
    ],
)
def test_a_stop_a_gap_and_teeth_lie_in_the_angle(effect, lies):
    assert lies_in_angle(PLAIN.layout.effect(effect)) is lies


@pytest.mark.parametrize(
    ("effect", "lost", "tried"),
    [("end_stop", 0.2, [4.0, 5.0]), ("end_stop", None, [4.0]), ("constant_load", 0.2, [4.0])],
)
def test_where_counts_are_lost_a_stop_is_tried_further_away_too(effect, lost, tried):
    first = PLAIN.layout.effect(effect).parameters[0].symbol
    losses = {} if lost is None else {"missed_counts": {"loss_fraction": lost, "speed_threshold_rad_s": 4.0}}
    plain = plant_from_config({"kind": "dc_motor", **NOMINAL, "effects": losses}, "power_pct")
    others = {p.symbol: p.starts[0] * p.si for p in PLAIN.layout.effect(effect).parameters[1:]}
    plant = plain.with_effect(effect, {first: 4.0, **others})
    plants = further_away(plant, PLAIN.layout.effect(effect))
    assert [one.values[Slot(effect, first)] for one in plants] == pytest.approx(tried)


def test_beside_a_stop_the_loss_is_found_that_no_fit_reaches_from_a_small_one():
    made: dict[str, Any] = {"effects": ("end_stop", "missed_counts"), "size": "large"}
    truth = make_case(152, link="usb", duration_s=12.0, **made).answer["effects"]
    lost = next(one["params"]["loss_fraction"] for one in truth if one["id"] == "missed_counts")
    problem = problem_for(concealed(seed=152, seconds=12.0, **made))
    with Simulator(problem.plant.layout) as simulator:
        fits = Fits(simulator, problem)
        stop, loss = (problem.plant.layout.effect(each) for each in ("end_stop", "missed_counts"))
        baseline = fits.settled_baseline()
        stops = [
            fits.settled(baseline.plant.with_effect(stop.id, x), baseline.noise) for x in fits.starts(stop)
        ]
        stopped = min(stops, key=lambda one: one.fitted_cost)
        plants = losing(fits, stopped, loss)
        first, *others = (fits.settled(each, stopped.noise) for each in plants)
    found = min(others, key=lambda one: one.fitted_cost)
    assert first.plant.values[LOSS] < 0.5 * lost
    assert found.plant.values[LOSS] == pytest.approx(lost, abs=0.02)
    assert found.fitted_cost < first.fitted_cost - 100.0
