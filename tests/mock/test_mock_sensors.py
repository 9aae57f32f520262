"""Sensors as a client sees them: types, waiting times, modes, and the digital bus."""

from __future__ import annotations

import pytest
from mock_rig import Rig

import firmware_protocol as fp
from firmware_protocol import SensorMode, SensorType, Status, ultrasonic
from nxt_twin.mock.body.world import World


@pytest.mark.parametrize(
    ("sensor_type", "wait_ms"),
    [(SensorType.SWITCH, 20), (SensorType.SOUND_DB, 300), (SensorType.COLOR_FULL, None)],
)
def test_data_are_invalid_for_a_while_after_a_new_type(rig, sensor_type, wait_ms):
    rig.run(30)
    rig.firmware.inputs.ports[1].set_mode(sensor_type, SensorMode.RAW)
    waited = 0
    while waited < 1000:
        rig.run(1)
        if not rig.firmware.inputs.ports[1].invalid_data:
            break
        waited += 1
    assert waited == (wait_ms or 1000)


@pytest.mark.parametrize(
    ("sensor_type", "raw", "normalised"),
    [
        (SensorType.SWITCH, 300, 300),
        (SensorType.LIGHT_ACTIVE, 200, 1023),
        (SensorType.LIGHT_ACTIVE, 540, 523),
        (SensorType.LIGHT_INACTIVE, 1000, 0),
        (SensorType.SOUND_DBA, 577, 523),
        (SensorType.REFLECTION, 681, 523),
        (SensorType.CUSTOM, 500, 0),
    ],
)
def test_readings_are_normalised_by_the_type(rig, sensor_type, raw, normalised):
    sensor = rig.body.sensors[2]
    sensor.raw.set(raw)
    sensor.lit_raw.set(raw)
    rig.set_sensor(2, sensor_type)
    rig.run(310)
    values = rig.sensor(2)
    assert (values.raw, values.normalised, values.scaled) == (raw, normalised, normalised)
    assert values.valid
    assert not values.calibrated


@pytest.mark.parametrize(
    ("mode", "scaled"),
    [
        (SensorMode.RAW, 500),
        (SensorMode.PERCENT, 48),
        (SensorMode.BOOLEAN, 0),
        (SensorMode.CELSIUS, 239),
        (SensorMode.FAHRENHEIT, 750),
    ],
)
def test_the_mode_scales_the_reading(rig, mode, scaled):
    rig.body.sensors[2].raw.set(500)
    rig.set_sensor(2, SensorType.SWITCH, mode)
    rig.run(30)
    assert rig.sensor(2).scaled == scaled


def test_presses_are_counted_with_100_ms_of_debouncing(rig):
    rig.set_sensor(0, SensorType.SWITCH, SensorMode.PERIOD_COUNT)
    rig.run(30)
    for _ in range(3):
        for pressed in (1, 0):
            rig.body.sensors[0].pressed.set(pressed)
            rig.run(120)
    assert rig.sensor(0).scaled == 3
    for pressed in (1, 0, 1, 0):
        rig.body.sensors[0].pressed.set(pressed)
        rig.run(10)
    rig.run(200)
    assert rig.sensor(0).scaled <= 4
    rig.get(fp.ResetInputScaledValue(0))
    rig.run(2)
    assert rig.sensor(0).scaled == 0


def test_the_lamp_of_the_light_sensor_changes_its_reading(rig):
    readings = []
    for sensor_type in (SensorType.LIGHT_INACTIVE, SensorType.LIGHT_ACTIVE):
        rig.set_sensor(2, sensor_type)
        rig.run(40)
        readings.append(rig.sensor(2).normalised)
    assert readings[0] < readings[1]


def read_register(rig: Rig, register: int, length: int = 1) -> bytes:
    rig.get(ultrasonic.read_register(3, register, length))
    while rig.status(fp.LowSpeedGetStatus(3)) is Status.PENDING:
        pass
    data: bytes = rig.get(fp.LowSpeedRead(3)).received
    return data


@pytest.fixture
def sonar_rig(rig):
    rig.set_sensor(3, SensorType.LOW_SPEED_9V)
    rig.run(30)
    return rig


def test_the_ultrasonic_sensor_says_who_it_is_and_how_far_it_sees(sonar_rig):
    register = ultrasonic.UltrasonicRegister
    assert read_register(sonar_rig, register.VERSION, 8) == ultrasonic.VERSION
    assert read_register(sonar_rig, register.PRODUCT, 8) == ultrasonic.PRODUCT
    assert read_register(sonar_rig, register.KIND, 8) == ultrasonic.KIND
    assert read_register(sonar_rig, register.UNITS, 7) == ultrasonic.UNITS
    assert read_register(sonar_rig, register.MEASUREMENT) == b"\x3c"
    sonar_rig.body.sensors[3].distance_cm.set(17)
    sonar_rig.run(50)
    assert read_register(sonar_rig, register.MEASUREMENT) == b"\x11"


def test_a_single_shot_measures_once(sonar_rig):
    register = ultrasonic.UltrasonicRegister
    shoot = ultrasonic.write_register(3, register.COMMAND, ultrasonic.UltrasonicCommand.SINGLE_SHOT)
    sonar_rig.get(shoot)
    sonar_rig.run(80)
    assert read_register(sonar_rig, register.MEASUREMENT, 8) == b"\x3c" + b"\xff" * 7
    sonar_rig.body.sensors[3].distance_cm.set(17)
    sonar_rig.run(80)
    assert read_register(sonar_rig, register.MEASUREMENT) == b"\x3c"


def test_a_transaction_takes_the_time_of_its_bytes(sonar_rig):
    sonar_rig.get(ultrasonic.read_register(3, 0x00, 8))
    ticks = 1
    while sonar_rig.firmware.low_speed.status(3) is Status.PENDING:
        sonar_rig.run(1)
        ticks += 1
    assert 9 <= ticks <= 15


def test_a_sensor_without_9_volts_does_not_answer(rig):
    rig.set_sensor(3, SensorType.LOW_SPEED)
    rig.run(30)
    rig.get(ultrasonic.read_register(3, 0x42))
    rig.run(30)
    assert rig.status(fp.LowSpeedGetStatus(3)) is Status.BUS_ERROR


def test_a_sensor_that_stays_silent_times_out_after_100_ms(sonar_rig):
    sonar_rig.body.sensors[3].answering = False
    sonar_rig.get(ultrasonic.read_register(3, 0x42))
    sonar_rig.run(90)
    assert sonar_rig.status(fp.LowSpeedGetStatus(3)) is Status.PENDING
    sonar_rig.run(30)
    assert sonar_rig.status(fp.LowSpeedGetStatus(3)) is Status.BUS_ERROR
    sonar_rig.body.sensors[3].answering = True
    assert read_register(sonar_rig, 0x42) == b"\x3c"


def test_bad_i2c_requests_are_refused_with_their_own_status(sonar_rig):
    assert sonar_rig.status(fp.LowSpeedWrite(4, 1, 1, b"\x02")) is Status.VALUE_OUT_OF_RANGE
    assert sonar_rig.status(fp.LowSpeedWrite(3, 17, 0, bytes(17))) is Status.ILLEGAL_SIZE
    assert sonar_rig.status(fp.LowSpeedWrite(3, 1, 17, b"\x02")) is Status.ILLEGAL_SIZE
    assert sonar_rig.raw(fp.encode_request(fp.LowSpeedRead(4))) == bytes((2, 0x10, Status.VALUE_OUT_OF_RANGE))
    sonar_rig.get(ultrasonic.read_register(3, 0x42))
    assert sonar_rig.status(ultrasonic.read_register(3, 0x42)) is Status.CHANNEL_NOT_READY


def test_a_world_can_show_sensors_a_course():
    course = {"points": [(0.0, 100.0), (1.0, 20.0)], "between": "line"}
    rig = Rig(World.model_validate({"sensors": {4: {"kind": "ultrasonic", "distance_cm": course}}}))
    rig.set_sensor(3, SensorType.LOW_SPEED_9V)
    rig.run(450)
    near_60 = read_register(rig, 0x42)[0]
    rig.run(2000)
    assert 55 <= near_60 <= 68
    assert read_register(rig, 0x42) == b"\x14"


class Counted:
    """A value over time that counts how often it is taken."""

    def __init__(self):
        self.taken = 0

    def at(self, time_s):
        self.taken += 1
        return 500.0 + 10.0 * (time_s > 1.0)


@pytest.mark.parametrize(("mode", "rarely"), [(SensorMode.RAW, True), (SensorMode.TRANSITION_COUNT, False)])
def test_the_converter_takes_a_reading_when_it_is_asked_for_and_each_one_to_count(rig, mode, rarely):
    shown = Counted()
    rig.body.sensors[2].raw = shown
    rig.set_sensor(2, SensorType.SWITCH, mode)
    rig.run(500)
    before = shown.taken
    rig.run(400)
    assert (shown.taken - before < 3) is rarely
    first = rig.sensor(2).raw
    rig.run(400)
    assert (first, rig.sensor(2).raw) == (500, 510)
