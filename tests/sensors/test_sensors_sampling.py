"""Step, pace and noise from readings alone, made up and real."""

import numpy as np
import pytest

from nxt_twin.errors import MissingDataError
from nxt_twin.recording.case import read_case
from nxt_twin.recording.realdata import data_root, prepare_case
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.sampling import sampling_of


def moved_by_hand(noise, step=1.0, count=600, seed=0, every=1):
    rng = np.random.default_rng(seed)
    time_s = np.cumsum(rng.normal(0.061, 0.002, count))
    distance = 40.0 + 20.0 * np.sin(0.9 * time_s) + noise * rng.standard_normal(count)
    seen = distance[np.arange(count) // every * every]
    return time_s, np.round(seen / step) * step


@pytest.mark.parametrize("step", [1.0, 0.5, 2.0])
def test_step_and_pace(step):
    found = sampling_of(*moved_by_hand(0.2, step))
    assert found.quantum == step
    assert found.period_s == pytest.approx(0.061, abs=4 * found.period_std_s)
    assert found.jitter_s == pytest.approx(0.002, rel=0.15)
    assert found.stalls == 0


@pytest.mark.parametrize("noise", [0.6, 1.5])
def test_noise_beside_rounding(noise):
    found = sampling_of(*moved_by_hand(noise, count=3000))
    assert found.noise == pytest.approx(noise, rel=0.1)


def test_a_sensor_slower_than_its_polls_is_seen_to_hold():
    assert sampling_of(*moved_by_hand(0.0, step=0.1)).held_share < 0.05
    assert sampling_of(*moved_by_hand(0.0, step=0.1, every=2)).held_share > 0.3


def test_no_echo_is_no_reading():
    time_s, readings = moved_by_hand(0.2)
    lost = np.where(np.arange(readings.size) % 50 == 0, 255.0, readings)
    assert sampling_of(time_s, lost, 255.0).noise < 0.6


def test_refuses_what_tells_nothing():
    with pytest.raises(SensorError, match="too few"):
        sampling_of(np.arange(10.0), np.arange(10.0))
    with pytest.raises(SensorError, match="too few"):
        sampling_of(np.arange(100.0), np.full(100, 7.0))


@pytest.mark.real_data
def test_the_real_sensor_says_whole_centimetres_every_61_ms(tmp_path):
    try:
        folder = prepare_case("nxt-ultrasonic", data_root(), tmp_path)
    except MissingDataError as missing:
        pytest.skip(str(missing))
    case = read_case(folder)
    (recording,) = case.recordings
    assert case.plant == {"kind": "ultrasonic_sensor"}
    assert recording.rows == 303
    found = sampling_of(recording.time_s, recording.columns["s4_ultrasonic_cm"], 255.0)
    assert found.quantum == 1.0
    assert found.period_s == pytest.approx(0.061, abs=0.0005)
    assert found.stalls == 1
    assert found.noise < 0.3
