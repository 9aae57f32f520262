"""The mechanisms behind concealed sensor cases do what their effects are named for."""

import numpy as np
import pytest

from nxt_twin.blind.sensors import button, echo, photodiode
from nxt_twin.blind.sensors.cases import SENSOR_EFFECTS, SENSOR_SURPRISES, make_sensor_case


def heard(sensor, distance, angle=0.0, count=400):
    targets = np.full(count, float(distance))
    rng = np.random.default_rng(1)
    return echo.readings_cm(sensor, np.arange(count) * 0.06, targets, np.full(count, float(angle)), rng)


def test_an_echo_is_the_distance_in_whole_centimetres():
    told = heard(echo.EchoMechanism(), 1003.0)
    assert np.all(told == np.round(told))
    assert told.mean() == pytest.approx(100.3, abs=0.3)
    assert heard(echo.EchoMechanism(truncates=True), 1003.0).mean() == pytest.approx(99.8, abs=0.3)


def test_sound_is_faster_in_warm_air():
    assert echo.speed_of_sound_m_per_s(20.0) == pytest.approx(343.2, abs=0.3)
    warm = heard(echo.EchoMechanism(temperature_c=40.0), 1500.0).mean()
    assert warm == pytest.approx(150.0 * np.sqrt(293.15 / 313.15), abs=0.4)


def test_a_ringing_emitter_hears_nothing_or_the_second_bounce():
    assert np.all(heard(echo.EchoMechanism(blanked_mm=40.0), 30.0) == 255)
    told = heard(echo.EchoMechanism(blanked_mm=40.0, second_bounce=0.5), 30.0)
    assert set(np.unique(told[told < 255])) <= {5.0, 6.0, 7.0}
    assert np.mean(told == 255) == pytest.approx(0.5, abs=0.1)
    assert np.all(heard(echo.EchoMechanism(blanked_mm=40.0), 60.0) < 255)


def test_half_of_the_echoes_are_lost_at_the_beams_edge():
    sensor = echo.EchoMechanism(margin_db=16.0, best_mm=438.0)
    edge = 10.0 * np.sqrt(sensor.margin_db / sensor.turning_db)
    assert edge == pytest.approx(40.0)
    assert np.mean(heard(sensor, 438.0, edge) == 255) == pytest.approx(0.5, abs=0.1)
    assert np.mean(heard(sensor, 1400.0, edge) == 255) > 0.95
    assert np.mean(heard(sensor, 100.0, edge) == 255) > 0.95
    assert np.all(heard(sensor, 438.0, 0.0) < 255)


def test_jitter_grows_with_distance():
    sensor = echo.EchoMechanism(jitter_us_per_m=100.0)
    assert heard(sensor, 1500.0).std() > 3 * heard(sensor, 200.0).std()


def test_mains_light_flickers_at_twice_its_frequency():
    time_s = np.arange(0.0, 1.0, 1e-3)
    sensor = photodiode.Photodiode(swing_raw=20.0, noise_raw=0.0)
    raw = photodiode.readings_raw(sensor, time_s, np.full(time_s.size, 100.0), 0.3, np.random.default_rng(0))
    spectrum = np.abs(np.fft.rfft(raw - raw.mean()))
    assert np.argmax(spectrum) == 100


def test_the_amplifier_leaves_its_straight_part_at_the_ceiling():
    sensor = photodiode.Photodiode(ceiling_raw=300.0, headroom_raw=5.0, noise_raw=0.0)
    place = np.array([0.0, 10.0, 250.0])
    raw = photodiode.readings_raw(sensor, np.arange(3.0), place, 0.0, np.random.default_rng(0))
    assert abs(raw[0] - 595.0) <= 1
    assert abs(raw[1] - raw[0]) <= 1
    assert raw[2] == pytest.approx(900 - 500 + 380 * 250 / 280, abs=1)


def test_a_button_snaps_over_and_back_at_two_forces():
    made = button.ButtonMechanism(back_mm=1.9, rub_g=0.0)
    force = np.concatenate([np.arange(0.0, 90.0, 0.1), np.arange(90.0, 0.0, -0.1)])
    told = button.readings(made, np.arange(force.size) * 0.02, force, np.random.default_rng(0))
    closed = np.flatnonzero(told)
    assert force[closed[0]] == pytest.approx(button.press_force_g(made), abs=0.11)
    assert force[closed[-1]] == pytest.approx(button.release_force_g(made), abs=0.11)


@pytest.mark.parametrize("kind", SENSOR_EFFECTS)
def test_cases_are_the_same_for_the_same_seed_and_say_their_truth(kind):
    for effect in (*SENSOR_EFFECTS[kind], *SENSOR_SURPRISES[kind]):
        one, two = (make_sensor_case(kind, (effect,), 3) for _ in range(2))
        assert one.content["plant"] == {"kind": kind}
        assert set(one.effects) == {effect}
        for first, second in zip(one.recordings, two.recordings, strict=True):
            for name, values in first.columns.items():
                np.testing.assert_array_equal(values, second.columns[name])
        changed = make_sensor_case(kind, (), 3).recordings[1]
        assert not all(
            np.array_equal(values, changed.columns[name])
            for name, values in one.recordings[1].columns.items()
        )
