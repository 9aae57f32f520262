"""A fit must simulate: beside a plain fit of windows, started at the truth, and in the plant that is written."""

from pathlib import Path

import numpy as np
import pytest
from plain_windows import fitted_on_windows

from nxt_twin.blind.families.family import Order
from nxt_twin.blind.families.table import FAMILIES
from nxt_twin.blind.make import make_case
from nxt_twin.blind.sets import CasePlan
from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.judging.evidence import gather
from nxt_twin.diagnose.judging.horizons import Errors, best_at_every_horizon, errors_of
from nxt_twin.diagnose.search.searched import best_baseline, searched, settled_baseline
from nxt_twin.diagnose.search.settling import settled
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.simulate import Simulator
from nxt_twin.recording.case import Case

WINDOW_S = 2.0
OVER_THE_PLAIN_FIT = 1.1
OVER_THE_TRUTH = 1.2
BACKLASH, COMPLIANCE = ("backlash",), ("shaft_compliance",)
WORKSHOP = Order("workshop", CasePlan("workshop-21", 21, (), None), "usb", 10.0)


def home(effects):
    return make_case(21, effects=effects, size="medium" if effects else None, duration_s=12.0)


def workshop():
    return FAMILIES["workshop"].make(WORKSHOP)


def problem_of(made):
    listed = made.content["recordings"]
    fitted = tuple(r for r in made.recordings if r.name in listed)
    held_out = tuple(r for r in made.recordings if r.name not in listed)
    return problem_for(Case(made.name, Path(), made.content["plant"], fitted, held_out, "a"))


def not_held_out(problem):
    """For each recording that is fitted, its samples that carry a reading and are not held out."""
    held = {part.signals.name: part.counted for part in problem.held_out}
    return [
        np.isfinite(one.measured) & ~held.get(one.name, np.zeros(one.measured.size, dtype=bool))
        for one in problem.signals
    ]


@pytest.mark.parametrize(
    "make",
    [lambda: home(()), lambda: home(BACKLASH), lambda: home(COMPLIANCE), workshop],
    ids=["clean", "backlash", "shaft compliance", "workshop"],
)
def test_a_re_fitted_baseline_simulates_as_well_as_a_plain_fit_of_windows(make):
    problem = problem_of(make())
    with Simulator(problem.plant.layout) as simulator:
        plain = fitted_on_windows(simulator, problem.plant, problem.signals, not_held_out(problem))
        fitter = Fitter(simulator, problem)
        settled_one = settled_baseline(fitter)
        refit = best_baseline(fitter, settled_one, settled_one)
        off = [
            errors_of(simulator, problem, plant, refit.plant, refit.noise).at(WINDOW_S)
            for plant in (problem.plant, plain, refit.plant)
        ]
    assert off[1] < off[0]  # the plain fit is one
    assert off[2] <= OVER_THE_PLAIN_FIT * off[1]


@pytest.mark.parametrize("effects", [BACKLASH, COMPLIANCE], ids=lambda effects: effects[0])
def test_a_fit_that_starts_at_the_truth_stays_as_near_to_what_is_held_out(effects):
    made = home(effects)
    problem = problem_of(made)
    hidden = {effect["id"]: effect["params"] for effect in made.answer["effects"]}
    truth = plant_from_config({"kind": "dc_motor", **made.answer["base"], "effects": hidden}, "power_pct")
    with Simulator(problem.plant.layout) as simulator:
        fitter = Fitter(simulator, problem)
        found = settled(fitter, truth, first_guess(truth, problem.signals, problem.scale.torque))
        fitted = fit_everything(fitter, found.plant, found.noise)
        given, true, after = (
            errors_of(simulator, problem, plant, fitted.plant, fitted.noise).at(WINDOW_S)
            for plant in (problem.plant, truth, fitted.plant)
        )
    assert true < 0.2 * given  # it is the truth
    assert after <= OVER_THE_TRUTH * true


def test_the_plant_that_is_written_is_never_clearly_worse_than_the_baseline():
    problem = problem_of(home(BACKLASH))
    with Simulator(problem.plant.layout) as simulator:
        found = searched(simulator, problem, lambda _: None)
        evidence = gather(simulator, problem, found, np.random.default_rng(0))
        final = evidence.final
        written = errors_of(simulator, problem, evidence.written, final.plant, final.noise)
    allowed = np.where(np.array(written.seconds) <= WINDOW_S, 1.02, 1.1)
    for other in (evidence.baseline_errors, evidence.given_errors):
        least = np.maximum(allowed * np.array(other.rms), problem.tolerance)
        assert (np.array(written.rms) <= least).all()


SECONDS = (0.5, 2.0, 10.0, np.inf)
TOLERANCE = 0.5
BASELINE = (4.0, 4.0, 4.0, 4.0)


@pytest.mark.parametrize(
    ("improved", "written"),
    [
        ((1.0, 1.0, 1.0, 1.0), "improved"),
        ((4.07, 4.07, 1.0, 1.0), "improved"),
        ((4.09, 1.0, 1.0, 1.0), "baseline"),
        ((1.0, 4.09, 1.0, 1.0), "baseline"),
        ((1.0, 1.0, 4.3, 4.3), "improved"),
        ((1.0, 1.0, 4.5, 1.0), "baseline"),
        ((1.0, 1.0, 1.0, 4.5), "baseline"),
        ((1.0, np.inf, 1.0, 1.0), "baseline"),
    ],
)
def test_what_is_worse_at_one_horizon_is_not_written(improved, written):
    ranked = [("improved", improved), ("baseline", BASELINE), ("given", (9.0, 9.0, 9.0, 9.0))]
    assert best_at_every_horizon(errors(ranked), TOLERANCE) == written


def test_the_given_model_is_written_where_it_is_best():
    ranked = [("improved", (5.0,) * 4), ("baseline", BASELINE), ("given", (3.0,) * 4)]
    assert best_at_every_horizon(errors(ranked), TOLERANCE) == "given"


def test_errors_that_do_not_matter_decide_nothing():
    ranked = [("improved", (0.4,) * 4), ("baseline", (0.1,) * 4), ("given", (0.2,) * 4)]
    assert best_at_every_horizon(errors(ranked), TOLERANCE) == "improved"


def errors(ranked):
    return [(name, Errors(SECONDS, rms)) for name, rms in ranked]
