"""The open-circuit voltage from noisy readings under load."""

import numpy as np
import pytest

from nxt_twin.physics.supply import open_circuit

LEVEL_V, SLOPE_V_PER_S, LASTS_S = 8.0, -0.004, 25.0
MANY = 40


def off_v(*, noise_v, ohm=0.0, at_rest=1, readings=40):
    """How far the level in the middle is off, RMS over many recordings, V."""
    rng = np.random.default_rng(3)
    found = []
    for _ in range(MANY):
        time_s = np.sort(rng.uniform(0.0, LASTS_S, readings))
        effort = rng.uniform(0.2, 1.0, readings)
        effort[:at_rest] = 0.0
        drawn_a = effort * np.where(rng.random(readings) < 0.3, rng.uniform(0.0, 1.0, readings), 0.1)
        true_v = LEVEL_V + SLOPE_V_PER_S * time_s
        volts = true_v - ohm * drawn_a + noise_v * rng.standard_normal(readings)
        level_v, slope = open_circuit(time_s, volts, effort)
        middle_s = 0.5 * LASTS_S
        found.append(level_v + slope * middle_s - LEVEL_V - SLOPE_V_PER_S * middle_s)
    return float(np.sqrt(np.mean(np.square(found))))


def test_one_noisy_reading_at_rest_does_not_decide():
    assert off_v(noise_v=0.02) < 0.01


@pytest.mark.parametrize(("ohm", "most_v"), [(0.5, 0.01), (2.0, 0.025)])
def test_a_sag_under_load_hardly_lowers_the_level(ohm, most_v):
    assert off_v(noise_v=0.006, ohm=ohm) < most_v


@pytest.mark.parametrize("ohm", [0.0, 0.5, 2.0])
def test_many_readings_at_rest_tell_the_level_whatever_is_drawn_else(ohm):
    assert off_v(noise_v=0.006, ohm=ohm, at_rest=12) < 0.008


def test_without_any_reading_at_rest_the_sag_is_taken_off():
    assert off_v(noise_v=0.006, ohm=2.0, at_rest=0) < 0.05


def test_a_few_readings_that_are_far_off_do_not_count():
    time_s = np.linspace(0.0, 20.0, 30)
    volts = np.full(30, 7.5)
    volts[::6] = 0.0
    level_v, slope = open_circuit(time_s, volts, np.full(30, 0.5))
    assert level_v + 10.0 * slope == pytest.approx(7.5, abs=1e-3)


def test_readings_at_rest_set_the_level_of_a_short_recording():
    level_v, slope = open_circuit(np.arange(3.0), np.array([8.0, 7.6, 7.5]), np.array([0.0, 0.5, 0.9]))
    assert (level_v, slope) == (8.0, 0.0)
