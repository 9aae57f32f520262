"""Stalls of the host, found in a recording's stamps."""

import numpy as np
import pytest

from nxt_twin.recording.recording import Recording
from nxt_twin.recording.stalls import stalled_share, stalls, stalls_in_words


def recorded(waits_s):
    return Recording("run", {"time_s": np.concatenate([[5.0], 5.0 + np.cumsum(waits_s)])})


def polls(seed, count=4000):
    """Waits of 10 ms that vary a little, every 20th with a slow reading in it."""
    rng = np.random.default_rng(seed)
    return 0.01 + 0.0005 * rng.standard_normal(count) + 0.012 * (np.arange(count) % 20 == 0)


@pytest.mark.parametrize("seed", range(5))
def test_a_regular_recording_has_none(seed):
    assert stalls(recorded(polls(seed))) == ()


@pytest.mark.parametrize("seed", range(5))
def test_polls_at_random_moments_are_no_stalls(seed):
    assert stalls(recorded(np.random.default_rng(seed).exponential(0.01, 4000))) == ()


def test_constant_periods_and_few_rows_have_none():
    assert stalls(recorded(np.full(1000, 0.5))) == ()
    assert stalls(recorded(np.array([0.01, 3.0, 0.01]))) == ()


def test_each_stall_is_found_with_its_place_and_length():
    waits_s = polls(1)
    waits_s[[100, 101, 3000]] += [0.12, 0.06, 0.3]
    found = stalls(recorded(waits_s))
    assert [stall.row for stall in found] == [101, 102, 3001]
    assert [stall.length_s for stall in found] == pytest.approx([0.132, 0.06, 0.312], abs=0.005)
    assert found[0].start_s == pytest.approx(5.0 + waits_s[:100].sum())
    assert stalls_in_words(found).startswith("the host or the link stood still 3 times, for up to 31")
    assert stalled_share(recorded(waits_s)) == pytest.approx(0.504 / waits_s.sum(), rel=0.02)
    assert stalled_share(recorded(polls(1))) == 0.0
    assert "once" in stalls_in_words(found[:1])
    assert stalls_in_words(()) == ""
