"""Robots before and after a touch: made by seed, compared, counted."""

import numpy as np
import pytest

from nxt_twin.blind.robot.pairs import PairOutcome, _chance, _done, make_pair, pairs_as_text, solve_pairs


@pytest.mark.slow
def test_equal_seeds_make_equal_pairs_and_ten_in_a_row_hold_every_kind():
    one, other = make_pair(303), make_pair(303)
    first, again = one.after.recordings[0], other.after.recordings[0]
    assert np.array_equal(first.columns["pose_x_m"], again.columns["pose_x_m"])
    assert (one.done, one.after.plant) == (other.done, other.after.plant)
    assert one.done == _done(303, _chance(303))
    kinds = [PairOutcome(seed, _done(seed, _chance(seed)), "", ()).kind for seed in range(300, 310)]
    assert kinds == ["nothing"] * 3 + ["one change"] * 4 + ["two changes"] * 2 + ["unknown"]


@pytest.mark.slow
def test_a_touched_robot_is_named_by_what_was_done():
    (found,) = solve_pairs([305])
    assert found.done
    assert found.exact


def test_a_miss_is_counted_and_told_with_its_seed():
    missed = PairOutcome(7, ("track_m",), "unchanged", ())
    assert not missed.exact
    assert list(pairs_as_text([missed]))[1:] == ["seed 7, track_m: unchanged, nothing"]
    assert PairOutcome(9, ("unknown_nap",), "unexplained", ("track_m",)).exact
