"""The sound model."""

import numpy as np
import pytest
from sensors_firmware_scale import firmware_percent

from nxt_twin.sensors import sound
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.sound import SoundParameters, SoundTruth


def test_it_falls_with_loudness_and_stops_at_its_end():
    sensor = SoundParameters()
    means = [sound.expected(sensor, level).mean for level in (30.0, 60.0, 90.0, 120.0)]
    assert means[0] > means[1] > means[2] == means[3]
    assert firmware_percent(round(means[1]), "sound") == pytest.approx(20, abs=3)
    assert firmware_percent(round(means[2]), "sound") == 100


def test_the_a_weighting_is_the_standards():
    frequencies = np.array([100.0, 1000.0, 2500.0, 10000.0])
    np.testing.assert_allclose(sound.a_weighting_db(frequencies), [-19.1, 0.0, 1.3, -2.5], atol=0.06)


def test_weighted_it_is_deaf_to_low_tones():
    ear, ideal = SoundParameters(weighted=1.0), SoundParameters()
    assert sound.expected(ear, 80.0, 60.0).mean > sound.expected(ideal, 80.0, 60.0).mean + 100
    assert sound.expected(ear, 80.0, 1000.0).mean == pytest.approx(sound.expected(ideal, 80.0).mean, abs=1.0)


def test_a_fit_finds_the_parameters_within_its_own_doubt():
    true, truth = SoundParameters(), SoundTruth(np.repeat(np.arange(30.0, 100.0, 2.0), 10))
    inside = 0
    for seed in range(8):
        fitted = sound.fit(sound.simulate(true, truth, np.random.default_rng(seed)), truth)
        inside += sum(
            abs(getattr(fitted.parameters, name) - getattr(true, name)) < 1.96 * fitted.std[name]
            for name in fitted.names
        )
    assert inside >= 27  # of 32


def test_refuses_what_it_cannot_fit():
    with pytest.raises(SensorError, match="cannot fit weighted"):
        sound.fit(np.zeros(40), SoundTruth(np.zeros(40)), free=("weighted",))
    with pytest.raises(SensorError, match="too few"):
        sound.fit(np.full(40, np.nan), SoundTruth(np.zeros(40)))
