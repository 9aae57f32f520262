"""Where runs start, and the speed read off the readings there."""

from dataclasses import replace

import numpy as np
import pytest
from physics_samples import commanded

from nxt_twin.physics.smooth import half_window_s, smoothed
from nxt_twin.physics.start import at_rest, moving_start, restarts

QUANTUM = np.radians(1.0)


def reading(angle, time_s, **changes):
    """Whole-degree readings of `angle` at `time_s`."""
    run = commanded([(0.0, 0.0)], seconds=time_s[-1], stamps=time_s)
    counts = np.floor(angle / QUANTUM) * QUANTUM
    return replace(run, measured=counts, quantum=QUANTUM, **changes)


def stamps(*, seconds=3.0, jitter=0.0):
    regular = np.arange(round(seconds * 100) + 1) * 0.01
    return regular + jitter * np.random.default_rng(1).uniform(0.0, 0.01, regular.size)


@pytest.mark.parametrize("jitter", [0.0, 0.8])
@pytest.mark.parametrize("speed", [-15.0, -2.3, 0.9, 6.1])
def test_the_speed_of_a_ramp_is_right_to_the_quantum(speed, jitter):
    time_s = stamps(jitter=jitter)
    signals = reading(speed * time_s, time_s)
    position, found = smoothed(signals)
    inner = slice(10, -10)
    assert np.abs(found[inner] - speed).max() < QUANTUM / half_window_s(signals)
    assert abs(found[inner].mean() - speed) < 0.02
    assert np.abs(position[inner] - (speed * time_s)[inner]).max() < QUANTUM


def test_the_speed_of_a_smooth_swing_is_followed():
    time_s = stamps()
    _, found = smoothed(reading(np.sin(4.0 * time_s), time_s))
    assert np.abs(found - 4.0 * np.cos(4.0 * time_s))[10:-10].max() < QUANTUM / 0.04


def test_missing_readings_are_bridged():
    time_s = stamps()
    signals = reading(5.0 * time_s, time_s)
    signals.measured[1::3] = np.nan
    _, found = smoothed(signals)
    assert np.abs(found[15:-15] - 5.0).max() < QUANTUM / half_window_s(signals)


def test_where_readings_are_too_few_the_last_position_stands():
    time_s = stamps()
    signals = reading(5.0 * time_s, time_s)
    signals.measured[100:200] = np.nan
    position, speed = smoothed(signals)
    assert speed[150] == 0.0
    assert position[150] == pytest.approx(signals.measured[99])


def test_speeds_that_were_read_are_taken_as_they_are():
    time_s = stamps()
    run = commanded([(0.0, 0.0)], seconds=3.0, stamps=time_s)
    signals = replace(run, measured=np.full(time_s.size, 3.0), is_speed=True)
    position, speed = smoothed(signals)
    np.testing.assert_allclose(speed, 3.0, rtol=1e-6)
    np.testing.assert_allclose(position, 3.0 * time_s, rtol=1e-6)
    np.testing.assert_array_equal(at_rest(signals).speed, 3.0)


def test_a_run_at_rest_starts_once_from_the_first_reading():
    time_s = stamps()
    signals = reading(2.0 + 5.0 * time_s, time_s)
    signals.measured[:3] = np.nan
    start = at_rest(signals)
    np.testing.assert_array_equal(np.flatnonzero(start.at), [0])
    assert start.position[0] == signals.measured[3]
    assert start.speed[0] == 0.0


def test_a_moving_start_takes_the_first_readings_speed():
    time_s = stamps()
    start = moving_start(reading(6.0 * time_s, time_s))
    np.testing.assert_array_equal(np.flatnonzero(start.at), [0])
    assert start.speed[0] == pytest.approx(6.0, abs=QUANTUM / 0.04 * 2.0)


def test_restarts_come_at_even_spaces_and_only_where_something_was_read():
    time_s = stamps()
    signals = reading(6.0 * time_s, time_s)
    signals.measured[50] = np.nan
    at = np.flatnonzero(restarts(signals, 0.5).at)
    assert set(at) <= set(np.flatnonzero(np.isfinite(signals.measured)))
    assert at[0] == 0
    assert {100, 150, 200, 250, 300} <= set(at)


def test_a_motor_at_rest_whose_reading_flickers_starts_at_rest():
    time_s = stamps()
    flicker = np.where(np.arange(time_s.size) % 7 == 0, QUANTUM, 0.0)
    start = restarts(reading(flicker + 1e-9, time_s), 0.25)
    anew = np.flatnonzero(start.at)[1:]
    assert anew.size > 10
    assert np.all(start.speed[anew] == 0.0)


def test_part_of_a_start_is_that_of_its_rows():
    time_s = stamps()
    start = restarts(reading(6.0 * time_s, time_s), 0.5)
    rows = np.array([0, 100, 101])
    part = start.part(rows)
    np.testing.assert_array_equal(part.at, [True, True, False])
    np.testing.assert_array_equal(part.speed, start.speed[rows])
