"""Signals of rows that a link handed over in clumps."""

from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.physics.clumped import as_read
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.recorded import signals_of
from nxt_twin.recording.recording import Recording

ROWS, SIZE, POLL_S = 400, 4, 0.01
READ_S = POLL_S * np.arange(ROWS)
CAME_S = READ_S[np.arange(ROWS) // SIZE * SIZE + SIZE - 1]


def recorded(power_pct, tacho_deg, time_s=CAME_S):
    columns = {"time_s": time_s, "a_power_pct": power_pct, "a_tacho_deg": tacho_deg}
    return Recording("r.csv", columns)


def in_steps(every):
    """A power that changes each so many rows."""
    return 20.0 + 10.0 * (np.arange(ROWS) // every % 3)


TURNING_DEG = np.floor(300.0 * READ_S)


def test_readings_move_to_when_they_were_read():
    found = signals_of(recorded(in_steps(40), TURNING_DEG), "a")
    np.testing.assert_allclose(found.time_s, READ_S, atol=1e-5)
    assert found.clump_rows == SIZE
    assert found.interval_s == pytest.approx(POLL_S)
    one_by_one = signals_of(recorded(in_steps(40), TURNING_DEG, READ_S), "a")
    assert one_by_one.clump_rows == 0.0
    assert as_read(one_by_one) is one_by_one


def test_commands_that_change_with_a_clump_stay_and_those_that_change_within_move_with_their_rows():
    stay = signals_of(recorded(in_steps(40), TURNING_DEG), "a")
    np.testing.assert_allclose(stay.command_time_s, CAME_S[::40], atol=1e-5)
    move = signals_of(recorded(in_steps(37), TURNING_DEG), "a")
    np.testing.assert_allclose(move.command_time_s, READ_S[::37], atol=1e-5)


@pytest.mark.parametrize(("within", "spread"), [(1, False), (3, True)])
def test_rows_that_were_polled_at_once_stay_as_they_are_stamped(within, spread):
    """A burst's readings stand still, but for a count here or there."""
    rows = np.arange(ROWS)
    moved = np.where(rows % SIZE == 0, 4.0, float(within))
    signals = signals_of(recorded(in_steps(40), np.cumsum(moved)), "a")
    assert (signals.clump_rows > 0.0) is spread


def test_readings_of_a_clump_that_waited_are_left_out_but_for_the_last():
    came_s = np.where(np.arange(ROWS) < 200, CAME_S, CAME_S + 0.3)
    signals = signals_of(recorded(in_steps(40), TURNING_DEG, came_s), "a")
    left_out = np.flatnonzero(~np.isfinite(signals.measured))
    np.testing.assert_array_equal(left_out, [200, 201, 202])


@pytest.mark.parametrize(("later", "stay"), [(1, True), (2, False)])
def test_nine_of_ten_commands_have_to_change_with_a_clump_to_stay(later, stay):
    power = in_steps(32)
    changes = np.flatnonzero(np.diff(power)) + 1
    for change in changes[:later]:
        power[change] = power[change - 1]  # a row later, within the clump
    signals = signals_of(recorded(power, TURNING_DEG), "a")
    last_s = CAME_S if stay else READ_S
    assert signals.command_time_s[-1] == pytest.approx(last_s[changes[-1]], abs=1e-5)


@pytest.mark.parametrize(("missing", "spread"), [(36, True), (44, False)])
def test_rows_without_a_reading_of_their_own_make_no_clumps(missing, spread):
    """Two topics that come together have each a row."""
    tacho_deg = np.where(np.arange(ROWS) % 4 == 1, np.nan, TURNING_DEG)
    few = np.where(np.arange(ROWS) < 4 * missing, tacho_deg, TURNING_DEG)
    assert (signals_of(recorded(in_steps(40), few), "a").clump_rows > 0.0) is spread


def test_a_motor_at_rest_tells_nothing_of_bursts():
    still = signals_of(recorded(in_steps(40), np.zeros(ROWS)), "a")
    assert still.clump_rows == SIZE


def turned(open_s=0.0):
    """Readings of a motor that begins to turn after a second, by 6 rad/s."""
    columns = recorded(np.full(ROWS, 50.0), np.degrees(6.0 * np.maximum(READ_S - 1.0, 0.0)), READ_S)
    return replace(signals_of(columns, "a"), open_s=np.full(ROWS, open_s))


def test_a_reading_strays_by_its_speed_times_how_far_its_moment_is_open():
    run, loose = turned(), turned(2e-3)
    assert not run.strays.any()
    assert not loose.strays[:99].any()
    assert loose.strays[99] > 0.0  # the speed is that of 20 ms to either side
    np.testing.assert_allclose(loose.strays[110:], 6.0 * 2e-3, rtol=1e-9)
    assert not replace(loose, is_speed=True).strays.any()
    assert loose.part(np.arange(200, 300)).strays == pytest.approx(6.0 * 2e-3)


def test_an_observer_trusts_readings_less_whose_moments_are_open():
    noise = Noise(reading_std=0.005, disturbance_std=5.0, disturbance_time_s=0.15, damping_per_s=20.0)
    exact, loose = (observer(each, noise) for each in (turned(), turned(2e-3)))
    assert np.all(loose.gains[110:, 0] < 0.8 * exact.gains[110:, 0])
    assert np.all(loose.innovation_std[110:] > 1.5 * exact.innovation_std[110:])
    np.testing.assert_array_equal(loose.gains[:80], exact.gains[:80])
