"""The light model."""

import numpy as np
import pytest
from sensors_firmware_scale import firmware_percent

from nxt_twin.sensors import light
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.light import LightParameters, LightTruth


def test_readings_are_drawn_as_often_as_they_are_probable():
    sensor = LightParameters(2.0, 1010.0, 6.0)
    draws = 40_000
    drawn = light.simulate(sensor, LightTruth(np.full(draws, 3.0)), np.random.default_rng(0))
    values = np.arange(980.0, 1024.0)
    expected = np.exp(light.log_likelihood_each(sensor, values, LightTruth(np.full(values.size, 3.0))))
    seen = np.array([np.mean(drawn == value) for value in values])
    assert expected.sum() == pytest.approx(1.0, abs=1e-3)
    assert np.all(np.abs(seen - expected) < 5 * np.sqrt(np.maximum(expected, 1e-4) / draws))
    assert seen[-1] > 0.1  # beyond the converter's end everything is 1023


def test_a_fit_finds_the_line_within_its_own_doubt():
    true = LightParameters(-1.3, 700.0, 3.0)
    truth = LightTruth(np.linspace(0.0, 250.0, 200))
    inside = 0
    for seed in range(10):
        fitted = light.fit(light.simulate(true, truth, np.random.default_rng(seed)), truth)
        inside += sum(
            abs(getattr(fitted.parameters, name) - getattr(true, name)) < 1.96 * fitted.std[name]
            for name in fitted.names
        )
    assert inside >= 24  # of 30


@pytest.mark.parametrize(("side", "level"), [(1.0, 650.0), (-1.0, 350.0)])
def test_beyond_the_knee_the_response_goes_on_by_no_more_than_the_width(side, level):
    sensor = LightParameters(zero_raw=level, knee_raw=500.0, knee_width_raw=20.0, knee_side=side)
    far = light.expected(sensor, 0.0).mean
    assert far == pytest.approx(500.0 + side * 20.0, abs=0.1)
    nothing = LightParameters(zero_raw=1000.0 - level, knee_raw=500.0, knee_side=side)
    assert light.expected(nothing, 0.0).mean == 1000.0 - level


def test_flicker_needs_stamps_and_swings_at_its_frequency():
    sensor = LightParameters(zero_raw=500.0, flicker_amplitude_raw=10.0, flicker_frequency_hz=100.0)
    time_s = np.arange(0.0, 0.05, 1e-4)
    mean = light.mean_raw(sensor, LightTruth(np.zeros(time_s.size), time_s))
    assert np.ptp(mean) == pytest.approx(20.0, rel=1e-3)
    np.testing.assert_allclose(mean[100:], mean[:-100], atol=1e-9)
    with pytest.raises(SensorError, match="stamps"):
        light.mean_raw(sensor, LightTruth(np.zeros(3)))


def test_with_the_lamp_off_only_the_room_is_seen():
    sensor = LightParameters(slope_raw_per_mm=2.0, lamp=0.0)
    assert light.expected(sensor, 100.0).mean == sensor.zero_raw
    assert light.expected(sensor, 100.0, ambient_raw=-40.0).mean == sensor.zero_raw - 40.0


def test_percent_is_as_the_firmware_reckons_it():
    assert [firmware_percent(raw, "light") for raw in (0, 200, 548, 895, 1023)] == [100, 100, 50, 0, 0]
    assert firmware_percent(162, "sound") == 100
    assert firmware_percent(1023, "sound") == 0
