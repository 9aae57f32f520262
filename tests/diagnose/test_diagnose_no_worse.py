"""The baseline that is shown predicts unseen readings no worse than the model that was given."""

from types import SimpleNamespace

import pytest

from nxt_twin.diagnose.judging import evidence
from nxt_twin.diagnose.judging.horizons import Errors, least_wrong
from nxt_twin.diagnose.search.searched import Searched

SECONDS = (0.5, 2.0)
TOLERANCE = 0.1


def structure(rms):
    return SimpleNamespace(plant=rms, noise=None)


@pytest.fixture
def shown(monkeypatch):
    """What is shown of a re-fit and a given model by their errors, with an effect found or not."""
    monkeypatch.setattr(evidence, "errors_of", lambda _s, _p, plant, _b, _n: Errors(SECONDS, plant))

    def choose(refit, given, *, found):
        made = {"refit": structure(refit), "given": structure(given)}
        final = structure((0.2, 0.2)) if found else made["refit"]
        searched = Searched(SimpleNamespace(found=found), made["refit"], made["given"], final)
        chosen = evidence._no_worse_than_given(None, SimpleNamespace(tolerance=TOLERANCE), searched)
        return {
            "baseline": chosen.refit is made["given"],
            "final": chosen.final,
            "given": made["given"],
            "as it was": chosen is searched,
        }

    return choose


def test_a_re_fit_that_is_better_stays(shown):
    assert shown((1.0, 3.0), (2.0, 6.0), found=False)["as it was"]


def test_a_given_model_that_is_better_is_the_baseline_and_the_answer(shown):
    chosen = shown((2.0, 27.0), (2.0, 21.0), found=False)
    assert chosen["baseline"]
    assert chosen["final"] is chosen["given"]


def test_what_was_found_stays_beside_a_given_model_that_is_the_better_baseline(shown):
    chosen = shown((2.0, 27.0), (2.0, 21.0), found=True)
    assert chosen["baseline"]
    assert chosen["final"].plant == (0.2, 0.2)


def test_errors_below_what_matters_decide_nothing():
    assert least_wrong([Errors(SECONDS, (0.09, 1.0)), Errors(SECONDS, (0.01, 1.0))], TOLERANCE) == 0
