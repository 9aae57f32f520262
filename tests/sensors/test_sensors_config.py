"""Sensor models as YAML and back."""

import pytest

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.configs import configs_dir, load_plant_config
from nxt_twin.sensors.errors import SensorError
from nxt_twin.sensors.light import LightParameters
from nxt_twin.sensors.sound import SoundParameters
from nxt_twin.sensors.touch import TouchParameters
from nxt_twin.sensors.ultrasonic import UltrasonicParameters

CLASSES = {
    "ultrasonic_sensor": UltrasonicParameters,
    "light_sensor": LightParameters,
    "touch_sensor": TouchParameters,
    "sound_sensor": SoundParameters,
}

SAMPLES = (
    UltrasonicParameters(noise_mm=2.5, blind_distance_mm=40.0, max_angle_deg=55.0, air_temperature_c=31.0),
    UltrasonicParameters(),
    LightParameters(1.2, 400.0, knee_raw=500.0, knee_side=-1.0, flicker_amplitude_raw=7.0),
    TouchParameters(press_force_g=62.0, release_force_g=60.0),
    SoundParameters(weighted=1.0),
)


@pytest.mark.parametrize("sensor", SAMPLES)
def test_a_sensor_reads_back_from_what_it_writes(sensor):
    assert type(sensor).from_config(sensor.to_config()) == sensor


def test_effects_that_are_off_are_left_out():
    assert "effects" not in UltrasonicParameters().to_config()
    only = UltrasonicParameters(air_temperature_c=5.0).to_config()["effects"]
    assert only == {"ultrasonic_sound_speed": {"air_temperature_c": 5.0}}


@pytest.mark.parametrize(
    "path", sorted((configs_dir() / "sensors").glob("*.yaml")), ids=lambda path: path.stem
)
def test_every_sensor_that_comes_along_can_be_read_by_its_name(path):
    config = load_plant_config(path.stem)
    sensor = CLASSES[config["kind"]].from_config(config)
    assert sensor.to_config()["kind"] == config["kind"]


def test_the_papers_ultrasonic_sensor():
    sensor = UltrasonicParameters.from_config(load_plant_config("nxt_ultrasonic"))
    assert sensor.scale == 1.0055
    assert sensor.blind_distance_mm == 40.0
    assert sensor.zero_mm + sensor.near_offset_mm == 20.0
    assert (sensor.max_angle_deg, sensor.best_distance_mm) == (55.0, 438.0)


@pytest.mark.parametrize(
    ("config", "says"),
    [
        ({"kind": "light_sensor"}, "kind: ultrasonic_sensor"),
        ({"kind": "ultrasonic_sensor", "noise": 1.0}, "did you mean 'noise_mm'"),
        ({"kind": "ultrasonic_sensor", "noise_mm": "much"}, "'much' is no finite number"),
        ({"kind": "ultrasonic_sensor", "effects": {"stiction": {}}}, "unknown key 'stiction'"),
        ({"kind": "ultrasonic_sensor", "effects": {"ultrasonic_blind_zone": {"distance": 3}}}, "unknown key"),
        ({"kind": "ultrasonic_sensor", "effects": [1]}, "no mapping"),
    ],
)
def test_refuses_with_the_key_that_is_wrong(config, says):
    with pytest.raises(SensorError, match=says) as refused:
        UltrasonicParameters.from_config(config)
    assert isinstance(refused.value, NxtTwinError)
