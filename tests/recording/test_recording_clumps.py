"""Rows that come in clumps are told from rows that come one by one, and get the moments at which they were read."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nxt_twin.recording.clumps import (
    clump_ends,
    told_apart_s,
    usual_s,
    when_read,
)
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.stalls import stalled_share, stalls

POLL_S = 0.01


def still(stamps_s):
    """Readings of a motor at rest."""
    return np.zeros(stamps_s.size)


def taken_s(rows=400, seed=3):
    """When rows were read: each a hundredth of a second after the one before, or a little more or less."""
    return np.cumsum(POLL_S + 2e-4 * np.random.default_rng(seed).standard_normal(rows))


def clumped(read_at_s, size, apart_s=0.0):
    """The stamps of rows that came in clumps of `size`."""
    rows = np.arange(read_at_s.size)
    last = np.minimum(rows // size * size + size - 1, rows[-1])
    return read_at_s[last] + apart_s * (rows % size)


@given(size=st.integers(2, 12), apart_s=st.sampled_from([0.0, 1e-4, 1e-3]), seed=st.integers(0, 50))
def test_rows_of_clumps_get_the_moments_at_which_they_were_read(size, apart_s, seed):
    read_at_s = taken_s(seed=seed)
    stamps_s = clumped(read_at_s, size, apart_s)
    ends = clump_ends(stamps_s)
    assert ends.size == -(-read_at_s.size // size)
    read = when_read(stamps_s, ends, still(stamps_s), 1.0)
    found_s, known = read.time_s, read.known
    assert known.all()
    assert np.abs(found_s - read_at_s).max() < 0.24 * POLL_S + apart_s * size
    assert np.diff(found_s).min() > 0.0
    assert usual_s(stamps_s) == pytest.approx(POLL_S, rel=0.4)


@pytest.mark.parametrize("jitter", [0.02, 0.2])
def test_rows_that_come_one_by_one_are_no_clumps(jitter):
    rng = np.random.default_rng(4)
    polls_s = np.cumsum(POLL_S * np.maximum(1.0 + jitter * rng.standard_normal(400), 0.05))
    late_s = np.maximum.accumulate(polls_s + POLL_S * rng.random(400))
    for stamps_s in (polls_s, late_s):
        assert clump_ends(stamps_s).size == 0
    assert told_apart_s(polls_s) is polls_s
    assert np.diff(told_apart_s(late_s)).min() > 0.0  # some rows waited for the one before


@pytest.mark.parametrize(("pairs", "found"), [(150, False), (180, True)])
def test_a_link_clumps_where_two_fifths_of_the_rows_come_with_others(pairs, found):
    waits_s = np.full(400, POLL_S)
    waits_s[1 : 2 * pairs : 2] = 0.0
    assert (clump_ends(np.cumsum(waits_s)).size > 0) is found


@pytest.mark.parametrize(("share", "found"), [(0.19, True), (0.21, False)])
def test_a_row_came_with_another_within_a_fifth_of_the_usual_time(share, found):
    stamps_s = clumped(taken_s(), 2, share * POLL_S)
    assert (clump_ends(stamps_s).size > 0) is found


@pytest.mark.parametrize(("wait_s", "known"), [(0.008, 4), (0.012, 1)])
def test_of_a_clump_that_waited_only_the_last_row_has_a_known_moment(wait_s, known):
    read_at_s = POLL_S * np.arange(200.0)
    read_at_s[102:] += wait_s  # within a clump
    stamps_s = clumped(read_at_s, 4)
    found = when_read(stamps_s, clump_ends(stamps_s), still(stamps_s), 1.0).known
    assert found[100:104].sum() == known
    assert found[103]
    assert found[:100].all()
    assert found[104:].all()


def test_equal_stamps_are_told_apart_and_keep_their_order():
    stamps_s = clumped(POLL_S * np.arange(200.0), 5)
    apart_s = told_apart_s(stamps_s)
    assert np.diff(apart_s).min() > 0.0
    assert np.abs(apart_s - stamps_s).max() < 1e-5
    np.testing.assert_array_equal(apart_s[::5], stamps_s[::5])


def test_a_link_that_clumps_has_not_stood_still():
    stamps_s = clumped(taken_s(), 4)
    recording = Recording("r", {"time_s": stamps_s, "a_power_pct": np.zeros(stamps_s.size)})
    assert stalls(recording) == ()
    stamps_s = np.where(np.arange(stamps_s.size) < 200, stamps_s, stamps_s + 0.5)
    halted = Recording("r", {"time_s": stamps_s, "a_power_pct": np.zeros(stamps_s.size)})
    (found,) = stalls(halted)
    assert found.row == 200
    assert stalled_share(halted) == pytest.approx(0.5 / float(np.ptp(stamps_s)), rel=0.05)


@pytest.mark.parametrize(("alone", "clumps"), [(0.4, True), (0.6, False)])
def test_a_link_clumps_where_most_clumps_have_more_than_one_row(alone, clumps):
    rng = np.random.default_rng(7)
    sizes = np.where(rng.random(400) < alone, 1, 5)
    ends = np.cumsum(sizes) - 1
    stamps_s = np.repeat(POLL_S * ends, sizes)
    assert (clump_ends(stamps_s).size > 0) is clumps


@pytest.mark.parametrize("late_rows", [1, 2, 3])
def test_a_clump_waited_where_its_readings_move_most(late_rows):
    first = 104 - late_rows
    read_at_s = POLL_S * np.arange(200.0)
    read_at_s[first:] += 0.05
    stamps_s = clumped(read_at_s, 4)
    found = when_read(stamps_s, clump_ends(stamps_s), 300.0 * read_at_s, 1.0)
    np.testing.assert_allclose(found.time_s, read_at_s, atol=1e-3)
    assert not found.known[100:103].any()


@pytest.mark.parametrize(("step_deg", "early"), [(5.9, False), (6.1, True)])
def test_a_motor_that_hardly_moves_in_a_clump_waited_before_it(step_deg, early):
    read_at_s = POLL_S * np.arange(200.0)
    read_at_s[102:] += 0.05
    stamps_s = clumped(read_at_s, 4)
    moved_deg = np.zeros(200)
    moved_deg[101], moved_deg[102] = 1.0, step_deg
    found = when_read(stamps_s, clump_ends(stamps_s), np.cumsum(moved_deg), 1.0)
    assert (found.time_s[101] - found.time_s[99] < 3.0 * POLL_S) == early


def test_the_last_clump_of_a_recording_follows_the_one_before_it_and_tells_no_moment():
    read_at_s = POLL_S * np.arange(203.0)
    stamps_s = clumped(read_at_s, 5)
    stamps_s[200:] += 2.0 * POLL_S  # a timer sends it when the next two rows would have been there
    found = when_read(stamps_s, clump_ends(stamps_s), 300.0 * read_at_s, 1.0)
    np.testing.assert_allclose(found.time_s, read_at_s, atol=1e-3)
    assert not found.known[200:].any()
    assert found.known[:200].all()


def test_a_timer_may_send_a_clump_in_the_midst_of_a_wait():
    read_at_s = POLL_S * np.arange(1000.0)
    read_at_s[500:] += 0.07
    period_s = 3.37 * POLL_S
    stamps_s = (np.floor(read_at_s / period_s) + 1.0) * period_s
    found = when_read(stamps_s, clump_ends(stamps_s), 300.0 * read_at_s, 1.0)
    late_s = found.time_s - read_at_s
    assert np.abs(late_s - np.median(late_s))[found.known].max() < 0.6 * POLL_S
    assert np.abs(late_s - np.median(late_s))[495:505].max() < POLL_S
