"""How old held readings are: what repeats tells when it came first."""

import numpy as np
import pytest
from diagnose_motors import clean_case

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.held_ages import with_ages
from nxt_twin.physics.signals import Signals

POLL_S, REFRESH_S = 0.01, 0.04


def turning(readings, stamps_s):
    """Signals of a motor that nothing drives, with these readings."""
    return Signals(
        name="turning",
        channel="a_tacho_deg",
        input_kind="power_pct",
        command_time_s=np.zeros(1),
        command=np.zeros(1),
        command_mode=np.zeros(1, dtype=np.int64),
        command_supply_v=np.full(1, 8.0),
        time_s=stamps_s,
        measured=readings,
        is_speed=False,
        quantum=1.0,
    )


def held_ramp(rows, refresh_s=REFRESH_S):
    """A motor at 1000 steps a second whose encoder is read each 40 ms, in the middle between two polls."""
    stamps_s = POLL_S * np.arange(rows)
    taken_s = np.floor((stamps_s - 0.005) / refresh_s) * refresh_s + 0.005
    return turning(1000.0 * taken_s, stamps_s), taken_s


def test_ages_of_held_readings_are_known_to_half_a_poll():
    signals, taken_s = held_ramp(400)
    (known,) = with_ages([signals])
    shown_s, unseen_s, *_ = known.ages.T
    second = np.flatnonzero(np.diff(signals.measured))[0] + 1
    np.testing.assert_allclose(unseen_s[second:], POLL_S)
    np.testing.assert_allclose(
        (shown_s + 0.5 * unseen_s)[second:], (signals.time_s - taken_s)[second:], atol=1e-9
    )
    assert (known.ages[:second, :2] == -1.0).all()
    assert known.refreshed_s == pytest.approx(REFRESH_S)


def test_a_device_that_refreshes_by_its_own_clock_tells_ages_of_repeats_to_a_millisecond():
    signals, taken_s = held_ramp(2000, 0.0373)
    (known,) = with_ages([signals])
    shown_s, unseen_s, *_ = known.ages[10:-10].T
    off_s = shown_s + 0.5 * unseen_s - (signals.time_s - taken_s)[10:-10]
    assert np.percentile(np.abs(off_s), 80) < 1e-3  # but for new ones, which are of half a poll at least
    assert np.abs(off_s).max() < 0.6 * POLL_S
    np.testing.assert_allclose(unseen_s, POLL_S)
    assert known.refreshed_s == pytest.approx(0.0373, rel=3e-3)


def test_where_refreshments_come_at_random_repeats_alone_tell_ages():
    rng = np.random.default_rng(5)
    refreshed_s = np.cumsum(rng.uniform(0.02, 0.06, 500))
    stamps_s = POLL_S * np.arange(1900)
    before = refreshed_s[np.searchsorted(refreshed_s, stamps_s, side="right") - 1]
    (known,) = with_ages([turning(1000.0 * np.where(stamps_s < refreshed_s[0], 0.0, before), stamps_s)])
    fresh = np.flatnonzero(np.diff(known.measured))[1:] + 1
    assert np.mean(known.ages[fresh, 0] == 0.0) > 0.9


def test_a_reading_of_a_motor_at_rest_is_no_older_than_a_refreshment():
    signals, _ = held_ramp(400)
    signals.measured[300:] = signals.measured[300]
    (known,) = with_ages([signals])
    np.testing.assert_allclose(known.ages[350:].sum(axis=1), REFRESH_S)


def test_a_stall_is_no_refreshment():
    signals, _ = held_ramp(400)
    late = turning(signals.measured, signals.time_s + np.where(np.arange(400) > 200, 0.5, 0.0))
    (known,) = with_ages([late])
    assert late.time_s[201] - late.time_s[200] > 0.5
    assert known.refreshed_s == pytest.approx(REFRESH_S)


def test_a_row_without_a_reading_is_passed_over():
    whole, _ = held_ramp(400)
    gap = turning(np.where(np.arange(400) == 103, np.nan, whole.measured), whole.time_s)
    whole, gap = (with_ages([each])[0].ages for each in (whole, gap))
    assert (gap[103, :2] == -1.0).all()
    np.testing.assert_allclose(np.delete(gap, 103, axis=0), np.delete(whole, 103, axis=0))


def test_parts_keep_the_ages_of_their_rows():
    (known,) = with_ages([held_ramp(400)[0]])
    rows = np.arange(50, 90)
    np.testing.assert_array_equal(known.part(rows).ages, known.ages[rows])


def test_readings_that_are_not_held_have_no_ages():
    assert all((signals.ages[:, :2] == -1.0).all() for signals in problem_for(clean_case(41)).signals)


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_next_to_no_readings_are_not_held(rows):
    signals, _ = held_ramp(rows)
    assert with_ages([signals])[0] is signals


def test_readings_that_never_jump_twice_tell_no_period():
    steps = np.tile([0.0, 0.0, 3.0, 0.0, 1.0], 40)
    signals = turning(np.cumsum(steps), POLL_S * np.arange(steps.size))
    assert with_ages([signals])[0] is signals
