"""A next experiment where readings and priors leave numbers open."""

import numpy as np
import pytest

from nxt_twin.diagnose.next.next_experiment import _left


def test_numbers_that_are_fixed_by_nothing_end_no_proposal():
    free = np.full((2, 2), 1e20)  # both numbers only together, and so firmly that no other term counts
    assert _left(free, np.zeros((2, 3)), np.array([1.0, 2.0, 2.0])) == pytest.approx(4.5)


def test_a_free_move_takes_what_lies_along_its_slope():
    slopes, apart = np.array([[1.0, 0.0]]), np.array([3.0, 4.0])
    assert _left(np.zeros((1, 1)), slopes, apart) == pytest.approx(8.0)
    assert _left(np.full((1, 1), 1e12), slopes, apart) == pytest.approx(12.5)
