"""The next step of a search for the likeliest noise, where some of its runs ran away."""

import warnings

import numpy as np
import pytest

from nxt_twin.diagnose.fitting.noise import to_the_lowest

FREE = np.array([False, False])


def test_a_paraboloid_is_followed_to_its_lowest_point():
    right, up = 0.4, -0.2
    points = np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]])
    costs = np.sum((points - [right, up]) ** 2, axis=1)
    step, fall = to_the_lowest(costs, FREE)
    assert step == pytest.approx([right, up])
    assert fall == pytest.approx(right**2 + up**2)


@pytest.mark.parametrize(
    ("costs", "fall"),
    [
        ([5.0, np.inf, 3.0, np.inf, np.nan, np.inf], 2.0),
        ([np.inf, np.inf, 3.0, np.inf, np.nan, np.inf], np.inf),
        ([np.inf] * 6, 0.0),
        ([np.nan] * 6, 0.0),
    ],
)
def test_runs_that_ran_away_lead_to_the_best_that_did_not_and_warn_nobody(costs, fall):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        step, found = to_the_lowest(np.array(costs), FREE)
    assert found == fall
    assert step.tolist() == ([-3.0, 0.0] if np.isfinite(costs[2]) else [0.0, 0.0])
