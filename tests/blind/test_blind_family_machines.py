"""What every foreign machine must do, whatever its equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from blind_numbers import PLAIN

from nxt_twin.blind.families.stiff.machine import Stiff
from nxt_twin.blind.families.workshop.machine import Workshop

STOPS_S = np.linspace(0.05, 1.0, 20)
DRIVE, FLOAT, COAST, BRAKE = range(4)

machines = pytest.mark.parametrize("machine", [Workshop, Stiff])


def duty_for(torque_nm):
    return torque_nm * PLAIN.resistance_ohm / (PLAIN.torque_constant_nm_per_a * PLAIN.supply_v)


def speed(hub_rad):
    return (hub_rad[-1] - hub_rad[-2]) / (STOPS_S[-1] - STOPS_S[-2])


@machines
def test_the_steady_speed_balances_drive_and_friction(machine):
    constant, ohm = PLAIN.torque_constant_nm_per_a, PLAIN.resistance_ohm
    drive = constant * 0.6 * PLAIN.supply_v / ohm - PLAIN.coulomb_nm
    expected = drive / (constant**2 / ohm + PLAIN.viscous_friction_nm_s_per_rad)
    assert speed(machine(PLAIN, 0.0).run(STOPS_S, 0.6, DRIVE)[:, 0]) == pytest.approx(expected, rel=0.02)


@machines
def test_friction_holds_up_to_its_level_and_no_further(machine):
    assert abs(machine(PLAIN, 0.0).run(STOPS_S, duty_for(7e-3), DRIVE)[-1, 0]) < np.deg2rad(0.5)
    assert machine(PLAIN, 0.0).run(STOPS_S, duty_for(14e-3), DRIVE)[-1, 0] > np.deg2rad(5.0)


@machines
def test_a_stop_holds_the_hub_and_lets_it_go(machine):
    motor = machine(replace(PLAIN, stop_side=1.0, stop_rad=1.0), 0.0)
    assert motor.run(STOPS_S, 0.6, DRIVE)[-1, 0] == pytest.approx(1.0, abs=0.05)
    assert motor.run(STOPS_S + 1.0, -0.6, DRIVE)[-1, 0] < 0.0


@machines
def test_a_load_behind_play_is_taken_along(machine):
    motor = replace(PLAIN, load_inertia_kg_m2=1.2e-3, gap_rad=np.deg2rad(16.0))
    behind = machine(motor, 0.0).run(STOPS_S, 0.6, DRIVE)[1, 0]
    alone = machine(PLAIN, 0.0).run(STOPS_S, 0.6, DRIVE)[1, 0]
    together = machine(replace(PLAIN, inertia_kg_m2=2.4e-3), 0.0).run(STOPS_S, 0.6, DRIVE)[1, 0]
    assert together < behind < alone


@machines
def test_a_braked_motor_stops_sooner_than_a_coasting_one(machine):
    ways = []
    for mode in (BRAKE, COAST):
        motor = machine(PLAIN, 0.0)
        motor.run(STOPS_S, 0.8, DRIVE)
        ways.append(float(np.ptp(motor.run(STOPS_S + 1.0, 0.0, mode)[:, 0])))
    assert ways[0] < 0.5 * ways[1]


@machines
def test_pieces_of_a_run_make_the_whole_run(machine):
    whole = machine(PLAIN, 0.0).run(STOPS_S, 0.6, DRIVE)[-1, 0]
    motor = machine(PLAIN, 0.0)
    pieces = [motor.run(np.array([stop]), 0.6, DRIVE) for stop in STOPS_S]
    assert pieces[-1][0, 0] == pytest.approx(whole, abs=np.deg2rad(0.2))


@machines
def test_internal_resistance_shows_in_the_batterys_voltage(machine):
    motor = machine(replace(PLAIN, internal_resistance_ohm=2.0, stop_side=1.0, stop_rad=0.3), 0.0)
    assert motor.run(STOPS_S, 1.0, DRIVE)[-1, 2] < PLAIN.supply_v - 1.0


@machines
def test_a_machine_that_begins_before_a_recording_has_warmed_and_drained_as_told_at_its_first_row(machine):
    drained = machine(replace(PLAIN, drain_v_per_s=0.5), 0.0, -2.0)
    assert drained.run(np.array([-1.0, 0.0, 1.0]), 0.0, COAST)[:, 2] == pytest.approx([8.5, 8.0, 7.5])
    cold = replace(PLAIN, cold_extra_torque_nm=0.02, warmup_time_s=0.3)
    before, fresh = machine(cold, 0.0, -2.0), machine(cold, 0.0)
    before.run(np.array([0.0]), 0.0, DRIVE)
    assert before.run(STOPS_S, 0.6, DRIVE)[-1, 0] == pytest.approx(
        fresh.run(STOPS_S, 0.6, DRIVE)[-1, 0], rel=1e-3
    )
