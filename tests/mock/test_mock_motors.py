"""Motors as a client sees them: run states, ramps, regulation, counters, and the physics behind."""

from __future__ import annotations

import pytest
from mock_rig import USB, Rig

import firmware_protocol as fp
from benchmarks.mock_tacho_limit import LIMIT, overrun
from firmware_protocol import RegulationMode, RunState, Status
from nxt_twin.mock.body.motors import MotorBank
from nxt_twin.mock.body.world import World
from nxt_twin.physics.plant import plant_from_config
from nxt_twin.physics.stepper import Stepper
from nxt_twin.recording.configs import load_plant_config


def degrees_per_second(rig: Rig, port: int) -> float:
    before = rig.motor(port).tacho_count
    rig.run(999)
    return rig.motor(port).tacho_count - before


@pytest.mark.parametrize("power", [30, -50, 70])
def test_a_regulated_motor_reaches_ten_degrees_a_second_for_each_percent(rig, power):
    rig.drive(0, power, mode=0x07, regulation=RegulationMode.SPEED)
    rig.run(3000)
    assert degrees_per_second(rig, 0) == pytest.approx(10 * power, abs=12)


def test_a_loaded_motor_turns_slower_unless_it_is_regulated():
    plant = {
        "kind": "dc_motor",
        "effects": {"constant_load": {"load_torque_nm": -0.1}},
        "resistance_ohm": 7.6,
        "torque_constant_nm_per_a": 0.4908,
        "back_emf_v_s_per_rad": 0.4908,
        "inertia_kg_m2": 1.2e-3,
    }
    rig = Rig(World(motors={"a": plant}))
    for port in (0, 1):
        rig.drive(port, 60)
    rig.run(1500)
    assert abs(degrees_per_second(rig, 0)) < 0.8 * degrees_per_second(rig, 1)
    for port in (0, 1):
        rig.drive(port, 60, mode=0x07, regulation=RegulationMode.SPEED)
    rig.run(4000)
    assert degrees_per_second(rig, 0) == pytest.approx(degrees_per_second(rig, 1), abs=15)


def test_position_regulation_goes_to_an_absolute_count_and_stays(rig):
    for target in (360, -90):
        rig.drive(0, 0, mode=0x07, regulation=RegulationMode.POSITION, limit=target & 0xFFFFFFFF)
        rig.run(6000)
        assert rig.motor(0).tacho_count == pytest.approx(target, abs=25)


def test_a_ramp_up_ends_at_its_limit_with_its_full_speed(rig):
    rig.drive(0, 80, state=RunState.RAMP_UP, limit=1000)
    powers = set()
    for _ in range(4000):
        rig.run(1)
        powers.add(rig.firmware.outputs.ports[0].actual_speed)
        if rig.firmware.outputs.ports[0].run_state == RunState.IDLE:
            break
    assert set(range(10, 75)) <= powers
    assert rig.motor(0).tacho_count >= 1000


def test_a_ramp_up_to_a_slower_speed_keeps_the_old_one(rig):
    rig.drive(0, 80)
    rig.run(300)
    rig.drive(0, 40, state=RunState.RAMP_UP, limit=500)
    rig.run(3)
    assert rig.motor(0).run_state == RunState.RUNNING
    assert rig.firmware.outputs.ports[0].actual_speed == 80


def test_a_ramp_down_to_zero_ends_at_rest(rig):
    rig.drive(0, 80)
    rig.run(800)
    rig.drive(0, 0, state=RunState.RAMP_DOWN, limit=600)
    rig.run(4000)
    assert rig.motor(0).run_state == RunState.IDLE
    assert rig.firmware.outputs.ports[0].actual_speed == 0


def test_braking_stops_sooner_than_coasting(rig):
    for port in (0, 1):
        rig.drive(port, 80)
    rig.run(800)
    before = [rig.motor(port).tacho_count for port in (0, 1)]
    rig.drive(0, 0, mode=0x03)
    rig.coast(1)
    rig.run(3000)
    ways = [rig.motor(port).tacho_count - start for port, start in zip((0, 1), before, strict=True)]
    assert 0 < ways[0] < ways[1] / 3


def test_without_brake_the_speed_is_far_from_proportional_to_the_power(rig):
    rig.drive(0, 20, mode=0x03)
    rig.drive(1, 20, mode=0x01)
    rig.run(3000)
    assert degrees_per_second(rig, 1) > 1.5 * degrees_per_second(rig, 0)


def test_each_counter_is_reset_by_its_own_command(rig):
    rig.drive(0, 60)
    rig.run(500)
    rig.drive(0, 0, mode=0x03)
    rig.run(500)
    turned = rig.motor(0).tacho_count
    assert turned > 100
    for request, left in (
        (fp.ResetMotorPosition(0, relative=True), (turned, 0, turned)),
        (fp.ResetMotorPosition(0, relative=False), (turned, 0, 0)),
        (fp.ResetTachoCount(0), (0, 0, 0)),
    ):
        rig.get(request)
        rig.run(2)
        state = rig.motor(0)
        assert (state.tacho_count, state.block_tacho_count, state.rotation_count) == left


def test_a_synchronised_pair_stops_together_at_its_limit(rig):
    for port in (1, 2):
        rig.drive(port, 60, mode=0x07, regulation=RegulationMode.SYNC, limit=720)
    rig.run(4000)
    assert [rig.motor(port).run_state for port in (1, 2)] == [RunState.IDLE, RunState.IDLE]
    assert rig.motor(1).tacho_count > 700


def test_a_turning_pair_drives_its_motors_differently(rig):
    for port in (1, 2):
        rig.drive(port, 60, mode=0x07, regulation=RegulationMode.SYNC, turn=100)
    rig.run(2000)
    counts = [rig.motor(port).tacho_count for port in (1, 2)]
    assert counts[0] < -100
    assert counts[1] > 100


def test_a_command_acts_at_once_and_is_seen_in_the_next_pass(rig):
    rig.firmware.receive(USB, fp.encode_request(fp.SetOutputState(0, 50, 3, 0, 0, 0x20, 0)))
    rig.firmware.tick()
    assert rig.firmware.outputs.ports[0].actual_speed == 50
    assert len(rig.firmware.transmit(USB)) == 1


def test_wrong_ports_are_refused(rig):
    assert rig.status(fp.SetOutputState(3, 50, 3, 0, 0, 0x20, 0)) is Status.VALUE_OUT_OF_RANGE
    assert rig.status(fp.ResetTachoCount(3)) is Status.VALUE_OUT_OF_RANGE


def test_the_battery_sags_under_load_and_drains(rig):
    rig.run(200)
    idle_mv = rig.get(fp.GetBatteryLevel()).voltage_mv
    for port in range(3):
        rig.drive(port, 100)
    rig.run(170)
    assert rig.get(fp.GetBatteryLevel()).voltage_mv < idle_mv - 50
    for port in range(3):
        rig.coast(port)
    rig.run(3000)
    assert rig.body.battery.open_circuit_v < 8.2


@pytest.mark.parametrize(("brake", "winding_v"), [(True, 0.496 * 8.0), (False, 8.0)])
def test_a_bridge_draws_what_its_winding_takes_while_it_is_connected(brake, winding_v):
    stepper = Stepper([plant_from_config(load_plant_config("nxt_motor"), "power_pct")])
    motors = MotorBank(stepper)
    motors.set(0, -50, brake=brake)
    for _ in range(1000):
        drawn_a = motors.step(8.0, 1e-3)
    current_a = (winding_v - 0.4908 * abs(stepper.speed[0])) / 7.6
    assert drawn_a == pytest.approx(0.496 * current_a, rel=1e-3)


def test_a_limit_is_overrun_by_the_motors_coasting_and_the_ramp_down_alone():
    seen = overrun(load_plant_config("nxt_motor"))
    whole = seen.at_rest - LIMIT
    assert seen.at_limit == LIMIT
    assert 0.6 < (seen.let_go - LIMIT) / whole < 0.8
    assert seen.braked - LIMIT < 30
    smooth = overrun(load_plant_config("nxt_motor_as_printed"))
    assert smooth.let_go > seen.let_go + 100
