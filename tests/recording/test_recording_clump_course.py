"""Clumps that a timer sends or that a link delays: their last rows get an even course."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nxt_twin.recording.clump_course import even_course
from nxt_twin.recording.clumps import clump_ends, when_read

POLL_S = 0.01


def still(stamps_s):
    """Readings of a motor at rest."""
    return np.zeros(stamps_s.size)


def rows_s(rows=3000, jitter=0.0, seed=5):
    """When rows were read; their jitter adds up."""
    return np.cumsum(POLL_S * (1.0 + jitter * np.random.default_rng(seed).standard_normal(rows)))


def by_timer(read_at_s, period_s):
    """The stamps of rows that a timer sends."""
    return (np.floor(read_at_s / period_s) + 1.0) * period_s


def error_polls(read_at_s, stamps_s):
    """Mean and standard deviation of the errors of what is told, in polls."""
    off = (when_read(stamps_s, clump_ends(stamps_s), still(stamps_s), 1.0).time_s - read_at_s) / POLL_S
    return float(np.mean(off)), float(np.std(off))


@pytest.mark.parametrize(("polls", "jitter", "most"), [(2.4, 0.0, 0.12), (3.05, 0.0, 0.2), (4.5, 0.1, 0.22)])
def test_rows_that_a_timer_sends_get_the_moments_at_which_they_were_read(polls, jitter, most):
    mean, spread = error_polls(rows_s(jitter=jitter), by_timer(rows_s(jitter=jitter), polls * POLL_S))
    assert abs(mean) < 0.12
    assert spread < most


def test_a_timer_after_which_hosts_stood_still_is_told_all_the_same():
    read_at_s = rows_s() + 0.4 * (np.arange(3000) > 900) + 0.25 * (np.arange(3000) > 2000)
    stamps_s = by_timer(read_at_s, 3.4 * POLL_S)
    read = when_read(stamps_s, clump_ends(stamps_s), still(stamps_s), 1.0)
    assert np.std((read.time_s - read_at_s)[read.known]) < 0.2 * POLL_S
    assert np.sum(~read.known) < 12


@pytest.mark.parametrize("wait_polls", [0.2, 0.5])
def test_what_a_link_delays_by_chance_is_smoothed_away(wait_polls):
    read_at_s = rows_s()
    last = np.arange(3000) // 4 * 4 + 3
    wait_s = wait_polls * POLL_S * np.abs(np.random.default_rng(2).standard_normal(3000))
    stamps_s = read_at_s[last] + wait_s[last]
    mean, spread = error_polls(read_at_s, stamps_s)
    assert spread < 0.35 * np.std(wait_s) / POLL_S
    assert abs(mean) < 0.25 * wait_polls


def test_rows_that_a_device_counts_keep_the_moment_at_which_their_clump_came():
    read_at_s = rows_s(jitter=0.2)
    ends = np.arange(4, 3000, 5)
    course = even_course(read_at_s[ends], np.full(ends.size, 5), POLL_S)
    assert np.abs(course.read_s - read_at_s[ends]).max() < 0.4 * POLL_S
    assert not course.stalled.any()
    assert course.row_s == pytest.approx(POLL_S, rel=0.02)


def test_few_clumps_are_taken_as_they_came():
    came_s = np.array([0.05, 0.1, 0.15, 0.2])
    np.testing.assert_allclose(even_course(came_s, np.full(4, 5), POLL_S).read_s, came_s)


@given(
    seed=st.integers(0, 10_000),
    jitter=st.sampled_from([0.0, 0.02, 0.25, 0.5]),
    wait_polls=st.sampled_from([0.0, 0.1, 1.0, 3.0]),
    stalls=st.integers(0, 4),
)
def test_moments_keep_the_order_of_their_rows(seed, jitter, wait_polls, stalls):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(40, 400))
    read_at_s = np.cumsum(POLL_S * np.maximum(1.0 + jitter * rng.standard_normal(count), 0.1))
    for row in rng.integers(1, count, stalls):
        read_at_s[row:] += POLL_S * rng.uniform(1.0, 60.0)
    ends = np.unique(np.append(np.cumsum(rng.integers(1, 8, count)) - 1, count - 1))
    last = ends[np.searchsorted(ends, np.arange(count))]
    last = np.minimum(last, count - 1)
    came_s = read_at_s[last] + wait_polls * POLL_S * np.abs(rng.standard_normal(count))[last]
    stamps_s = np.maximum.accumulate(came_s)
    clumps = clump_ends(stamps_s)
    if clumps.size:
        read = when_read(stamps_s, clumps, np.cumsum(rng.integers(-1, 5, count)).astype(float), 1.0)
        assert np.diff(read.time_s).min() > 0.0
        assert np.isfinite(read.open_s).all()
        assert read.known.mean() > 0.5


@pytest.mark.parametrize(("wait_rows", "stalled"), [(2.8, 0), (3.2, 1)])
def test_a_clump_waited_beyond_four_standard_deviations(wait_rows, stalled):
    apart = 4.0 + 0.5 * (-1.0) ** np.arange(200)  # deviations of 0.74 rows, as a median tells them
    apart[100] = 4.0 + wait_rows
    course = even_course(POLL_S * np.cumsum(apart), np.full(200, 4), POLL_S)
    assert course.stalled.sum() == stalled


def test_what_comes_back_after_sixteen_clumps_is_no_walk():
    clumps = np.arange(801)
    came_s = POLL_S * (4.0 * clumps + 0.5 * np.sin(2.0 * np.pi * clumps / 16.0))
    course = even_course(came_s, np.full(801, 4), POLL_S)
    assert np.sqrt(course.walk_s2) / course.row_s == pytest.approx(0.01, rel=0.02)


def test_even_rows_that_a_timer_sends_stay_open_by_what_a_walk_of_a_hundredth_leaves():
    stamps_s = by_timer(rows_s(), 3.37 * POLL_S)
    read = when_read(stamps_s, clump_ends(stamps_s), still(stamps_s), 1.0)
    assert np.median(read.open_s) / POLL_S == pytest.approx(0.05, rel=0.15)
