"""The touch model and the population that its sensors come from."""

import numpy as np
import pytest

from nxt_twin.sensors import touch
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.touch import TouchParameters, TouchTruth
from nxt_twin.sensors.touch_population import fit_population, measured_units


def presses(count, step=0.5, low=40.0, high=80.0):
    cycle = np.concatenate([np.arange(low, high, step), np.arange(high, low, -step)])
    return np.tile(cycle, count)


def test_it_closes_and_opens_at_its_own_forces():
    sensor = TouchParameters(press_force_g=61.9, release_force_g=58.1, force_noise_g=1e-6)
    force = presses(1)
    told = touch.simulate(sensor, TouchTruth(force), np.random.default_rng(0))
    np.testing.assert_array_equal(told, touch.predict(sensor, TouchTruth(force)))
    closed = np.flatnonzero(told)
    assert force[closed[0]] == 62.0
    assert force[closed[-1] + 1] == 58.0


def test_the_ideal_sensor_switches_at_one_force_both_ways():
    sensor = TouchParameters(switch_force_g=60.0, force_noise_g=1e-6)
    assert sensor.thresholds("force_g")[:2] == (60.0, 60.0)
    told = touch.predict(sensor, TouchTruth(np.array([50.0, 61.0, 59.0, 61.0])))
    np.testing.assert_array_equal(told, [0, 1, 0, 1])


def test_a_stroke_says_between_which_values_the_threshold_lay():
    strokes = touch.strokes_of(
        np.array([0, 0, 1, 1, 0, np.nan, 0.0]), np.array([1.0, 3.0, 2.5, 5.0, 2.0, 9, 1.0])
    )
    np.testing.assert_array_equal(strokes.closes, [1, 0, 1])
    np.testing.assert_array_equal(strokes.low, [3.0, 2.0, 2.0])
    np.testing.assert_array_equal(strokes.high, [2.5, 2.5, np.inf])


def test_a_fit_finds_the_forces_within_its_own_doubt():
    true = TouchParameters(press_force_g=62.6, release_force_g=60.0, force_noise_g=0.5)
    inside = 0
    for seed in range(20):
        shown = TouchTruth(presses(16))
        fitted = touch.fit(touch.simulate(true, shown, np.random.default_rng(seed)), shown)
        inside += sum(
            abs(getattr(fitted.parameters, name) - getattr(true, name)) < 1.96 * fitted.std[name]
            for name in fitted.names
        )
    assert inside >= 51  # of 60


def test_by_travel_it_is_fitted_in_millimetres():
    true = TouchParameters(press_travel_mm=2.1, release_travel_mm=1.8, travel_noise_mm=0.01)
    shown = TouchTruth(presses(10, 0.01, 1.5, 2.5), "travel_mm")
    fitted = touch.fit(touch.simulate(true, shown, np.random.default_rng(0)), shown)
    assert fitted.parameters.press_travel_mm == pytest.approx(2.1, abs=4 * fitted.std["press_travel_mm"])
    assert fitted.parameters.release_travel_mm == pytest.approx(1.8, abs=4 * fitted.std["release_travel_mm"])


def test_what_it_was_a_moment_ago_counts_between_the_thresholds():
    sensor = TouchParameters(press_force_g=62.0, release_force_g=58.0, force_noise_g=0.5)
    assert touch.expected(sensor, 60.0, was_closed=False).mean < 0.01
    assert touch.expected(sensor, 60.0, was_closed=True).mean > 0.99


def test_refuses_what_never_switched():
    with pytest.raises(SensorError, match="never both"):
        touch.fit(np.zeros(50), TouchTruth(np.linspace(0.0, 10.0, 50)))


def test_the_papers_eight_sensors():
    units = measured_units()
    assert len(units) == 8
    assert units[0].press_force_g == 57.0
    assert units[6].press_force_g == pytest.approx(49.625)
    assert units[6].release_force_g == pytest.approx(47.75)  # the table prints 48.8, its row says otherwise
    assert np.mean([unit.press_force_g for unit in units]) == pytest.approx(61.58, abs=0.01)


def test_new_sensors_come_from_the_same_population():
    population = fit_population()
    drawn = [population.draw(np.random.default_rng(seed)) for seed in range(2000)]
    press = np.array([sensor.press_force_g for sensor in drawn])
    release = np.array([sensor.release_force_g for sensor in drawn])
    measured = measured_units()
    assert np.all(press >= release)
    assert press.mean() == pytest.approx(np.mean([unit.press_force_g for unit in measured]), abs=0.8)
    assert press.std() == pytest.approx(np.std([unit.press_force_g for unit in measured], ddof=1), rel=0.1)
    assert (press - release).mean() == pytest.approx(2.72, abs=0.3)
    assert np.all(np.array([s.press_travel_mm - s.release_travel_mm for s in drawn]) > 0)
    assert population.draw(np.random.default_rng(7)) == population.draw(np.random.default_rng(7))
