"""Which fits of the baseline a "before" is chosen from."""

import pytest
from diagnose_motors import clean_case

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting import baselines
from nxt_twin.diagnose.fitting.baselines import best_baseline, settled_baseline
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.simulate import Simulator

INERTIA = Slot(BASE_OWNER, "inertia")


def test_the_improved_plant_s_own_numbers_without_what_it_adds_are_one_of_them(monkeypatch):
    """An improved plant with an inertia that no fit would choose: only it can have brought that."""
    problem = problem_for(clean_case(11))
    with Simulator(problem.plant.layout) as simulator:
        fitter = Fitter(simulator, problem)
        settled = settled_baseline(fitter)
        odd = 3.0 * settled.plant.values[INERTIA]
        stop = {"limit": 1e3, "restitution": 0.4, "give": 0.0}
        improved = settled.plant.with_values({INERTIA: odd}).with_effect("end_stop", stop)
        final = baselines.standing(fitter, improved, settled.noise)
        tried = []

        def choose(_, errors, *__):
            tried.extend(errors)
            return len(errors) - 1

        monkeypatch.setattr(baselines, "best_fit", choose)
        before = best_baseline(fitter, settled, final)
    assert len(tried) > 1
    # of the motors that move alike, the priors choose one
    assert before.plant.values[INERTIA] == pytest.approx(odd, rel=0.1)
    assert before.plant.active == problem.plant.active
