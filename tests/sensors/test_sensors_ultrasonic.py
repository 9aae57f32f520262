"""The ultrasonic model: a proper distribution, the same when drawn as when weighed, and fits that know their doubt."""

from dataclasses import replace

import numpy as np
import pytest

from nxt_twin.sensors import ultrasonic
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.ultrasonic import UltrasonicParameters, UltrasonicTruth

PAPER = UltrasonicParameters(
    noise_mm=3.0,
    noise_per_distance=0.008,
    zero_mm=-2.0,
    scale=1.0055,
    blind_distance_mm=40.0,
    blind_silent_share=0.7,
    near_offset_mm=20.0,
    near_below_mm=250.0,
    near_share=0.8,
    max_angle_deg=55.0,
    beam_edge_deg=3.0,
    miss_probability=0.02,
    stray_probability=0.01,
)
TARGETS = np.array([15.0, 41.0, 100.0, 249.0, 400.0, 900.0, 1500.0, 2546.0])


@pytest.mark.parametrize(
    "sensor",
    [
        PAPER,
        replace(PAPER, noise_power=2.0, transducer_spacing_mm=28.0),
        replace(PAPER, crosstalk_per_mm=1e-4, noise_mm=0.5, blind_distance_mm=0.0),
    ],
)
@pytest.mark.parametrize("angle", [0.0, 35.0, 54.0])
def test_the_probabilities_of_all_readings_add_up_to_one(sensor, angle):
    truth = UltrasonicTruth(TARGETS, np.full(TARGETS.size, angle))
    total = sum(
        ultrasonic.reading_probability(sensor, np.full(TARGETS.size, float(reading)), truth)
        for reading in range(256)
    )
    np.testing.assert_allclose(total, 1.0, atol=0.01 if sensor.crosstalk_per_mm else 1e-9)


@pytest.mark.parametrize("sensor", [PAPER, replace(PAPER, crosstalk_per_mm=1.2e-4, near_share=0.0)])
@pytest.mark.parametrize("target", [(20.0, 0.0), (120.0, 10.0), (438.0, 54.0), (1400.0, 20.0)])
def test_readings_are_drawn_as_often_as_they_are_probable(sensor, target):
    draws = 20_000
    truth = UltrasonicTruth(np.full(draws, target[0]), np.full(draws, target[1]))
    drawn = ultrasonic.simulate(sensor, truth, np.random.default_rng(3))
    seen = np.bincount(drawn.astype(int), minlength=256) / draws
    one = UltrasonicTruth(np.full(256, target[0]), np.full(256, target[1]))
    expected = ultrasonic.reading_probability(sensor, np.arange(256.0), one)
    doubt = np.sqrt(np.maximum(expected * (1 - expected), 1e-4) / draws)
    assert np.all(np.abs(seen - expected) < 5 * doubt)


@pytest.mark.parametrize("target", [(20.0, 0.0), (120.0, 10.0), (438.0, 40.0), (1400.0, 5.0)])
def test_the_expected_reading_is_the_mean_of_drawn_ones(target):
    sensor = replace(PAPER, stray_probability=0.0)
    draws = 20_000
    truth = UltrasonicTruth(np.full(draws, target[0]), np.full(draws, target[1]))
    drawn = ultrasonic.simulate(sensor, truth, np.random.default_rng(4))
    expected = ultrasonic.expected(sensor, *target)
    heard = drawn < 255
    assert (~heard).mean() == pytest.approx(expected.p_no_echo, abs=0.02)
    assert drawn[heard].mean() == pytest.approx(expected.mean, abs=0.1)
    assert drawn[heard].var() == pytest.approx(expected.variance, rel=0.1, abs=0.03)


def test_the_beam_is_widest_where_the_paper_says():
    limits = ultrasonic.beam_limit_deg(PAPER, np.array([138.0, 438.0, 1538.0]))
    assert limits[1] == pytest.approx(55.0)
    assert limits[2] == pytest.approx(PAPER.far_angle_deg)
    assert limits[0] < limits[1]


def test_warm_air_brings_targets_nearer():
    assert ultrasonic.sound_speed(20.0) == pytest.approx(343.2, abs=0.1)
    warm = UltrasonicParameters(air_temperature_c=30.0)
    assert ultrasonic.expected(warm, 1000.0).mean == pytest.approx(100.0 * np.sqrt(293.15 / 303.15))


def test_emitter_and_receiver_apart_lengthen_short_paths_only():
    apart = UltrasonicParameters(transducer_spacing_mm=28.0)
    near, far = (ultrasonic.expected(apart, distance).mean * 10 - distance for distance in (40.0, 1500.0))
    assert near == pytest.approx(np.hypot(40.0, 14.0) - 40.0)
    assert far < 0.1


def test_another_sensors_pings_come_early():
    alone, together = UltrasonicParameters(), UltrasonicParameters(crosstalk_per_mm=1.2e-4)
    truth = UltrasonicTruth(np.full(5000, 1500.0))
    early = ultrasonic.simulate(together, truth, np.random.default_rng(1)) < 140
    assert early.mean() == pytest.approx(1400 * 1.2e-4, abs=0.02)
    assert not np.any(ultrasonic.simulate(alone, truth, np.random.default_rng(1)) < 140)


def test_polls_between_two_pings_see_the_same_reading_and_count_once():
    sensor = UltrasonicParameters(update_period_s=0.06, noise_mm=8.0)
    time_s = np.arange(600) * 0.02
    truth = UltrasonicTruth(300.0 + 100.0 * time_s, time_s=time_s)
    readings = ultrasonic.simulate(sensor, truth, np.random.default_rng(2))
    assert np.all(readings.reshape(-1, 3) == readings[::3, None])
    each = ultrasonic.log_likelihood_each(sensor, readings, truth)
    assert np.count_nonzero(each) == 200
    with pytest.raises(SensorError, match="stamps"):
        ultrasonic.log_likelihood(sensor, readings, UltrasonicTruth(truth.distance_mm))


def test_a_fit_finds_the_parameters_within_its_own_doubt():
    truth = UltrasonicTruth(np.repeat(np.arange(60.0, 1500.0, 6.0), 2))
    names = ("noise_mm", "noise_per_distance", "zero_mm", "scale")
    true = UltrasonicParameters(noise_mm=3.0, noise_per_distance=0.008, zero_mm=3.0, scale=1.0055)
    inside = 0
    for seed in range(8):
        readings = ultrasonic.simulate(true, truth, np.random.default_rng(seed))
        fitted = ultrasonic.fit(readings, truth)
        assert fitted.names == names
        inside += sum(
            abs(getattr(fitted.parameters, name) - getattr(true, name)) < 1.96 * fitted.std[name]
            for name in names
        )
    assert inside >= 27  # of 32; with honest doubts fewer come in one of 500


def test_a_threshold_between_two_distances_is_doubted_by_about_half_the_gap():
    truth = UltrasonicTruth(np.repeat(np.arange(10.0, 300.0, 10.0), 6))
    true = UltrasonicParameters(blind_distance_mm=45.0)
    readings = ultrasonic.simulate(true, truth, np.random.default_rng(1))
    fitted = ultrasonic.fit(
        readings,
        truth,
        start=UltrasonicParameters(blind_distance_mm=55.0),
        free=("noise_mm", "blind_distance_mm"),
    )
    assert fitted.parameters.blind_distance_mm == pytest.approx(45.0, abs=5.0)
    assert 1.0 < fitted.std["blind_distance_mm"] < 5.0


def test_readings_that_were_not_taken_do_not_count():
    truth = UltrasonicTruth(np.linspace(100.0, 500.0, 50))
    readings = ultrasonic.simulate(UltrasonicParameters(), truth, np.random.default_rng(0))
    some = np.where(np.arange(50) % 2, np.nan, readings)
    kept = UltrasonicTruth(truth.distance_mm[::2])
    assert ultrasonic.log_likelihood(UltrasonicParameters(), some, truth) == pytest.approx(
        ultrasonic.log_likelihood(UltrasonicParameters(), readings[::2], kept)
    )


def test_refuses_to_fit_what_it_cannot():
    truth = UltrasonicTruth(np.linspace(100.0, 500.0, 50))
    with pytest.raises(SensorError, match="cannot fit quantum_mm"):
        ultrasonic.fit(np.zeros(50), truth, free=("quantum_mm",))
    with pytest.raises(SensorError, match="too few"):
        ultrasonic.fit(np.full(50, np.nan), truth)
    with pytest.raises(SensorError, match="differ in length"):
        ultrasonic.log_likelihood(UltrasonicParameters(), np.zeros(3), truth)
