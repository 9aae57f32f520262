"""Dry friction holds exactly: nothing creeps, and nothing starts before its breakaway."""

import numpy as np
import pytest
from physics_samples import NXT, commanded, disc, motion, nxt

R, K, UB = NXT["resistance_ohm"], NXT["torque_constant_nm_per_a"], NXT["supply_v"]
BREAKAWAY_DUTY = R * NXT["coulomb_friction_nm"] / (K * UB)


@pytest.mark.parametrize("share", [-0.999, -0.5, 0.999])
def test_below_breakaway_a_motor_does_not_move_at_all(motor_simulator, share):
    run = commanded([(0.0, share * BREAKAWAY_DUTY)], seconds=20.0, every_s=0.1)
    found = motion(motor_simulator, nxt(), run)
    assert np.all(found["angle"] == 0.0)
    assert np.all(found["speed"] == 0.0)


@pytest.mark.parametrize("share", [-1.01, 1.01])
def test_just_above_breakaway_it_moves_on_and_on(motor_simulator, share):
    run = commanded([(0.0, share * BREAKAWAY_DUTY)], seconds=2.0)
    angle = motion(motor_simulator, nxt(), run)["angle"] * np.sign(share)
    assert np.all(np.diff(angle[10:]) > 0.0)


def test_a_motor_that_was_stopped_stays_at_exactly_zero_speed(motor_simulator):
    run = commanded([(0.0, 0.6), (0.5, 0.9 * BREAKAWAY_DUTY)], seconds=3.0)
    found = motion(motor_simulator, nxt(), run)
    rest = run.time_s > 1.5
    assert found["angle"][-1] > 1.0
    assert np.all(found["speed"][rest] == 0.0)
    assert np.ptp(found["angle"][rest]) == 0.0


def test_stiction_holds_what_it_lets_run_once_it_has_started(motor_simulator):
    plant = nxt(effects={"stiction": {"breakaway_torque_nm": 0.06, "stribeck_speed_rad_s": 0.5}})
    between = 6.0 * BREAKAWAY_DUTY
    held = motion(motor_simulator, plant, commanded([(0.0, between)], seconds=2.0))
    kicked = motion(motor_simulator, plant, commanded([(0.0, 0.5), (0.1, between)], seconds=4.0))
    assert np.all(held["angle"] == 0.0)
    assert kicked["speed"][-1] > 1.0


def test_a_drop_in_the_bridge_keeps_small_commands_from_acting(motor_simulator):
    plant = nxt(without=("coulomb_friction_nm",), effects={"voltage_drop": {"drop_v": 0.8}})
    below, above = (
        motion(motor_simulator, plant, commanded([(0.0, duty)], seconds=0.5))["angle"]
        for duty in (0.099, 0.102)
    )
    assert np.all(below == 0.0)
    assert above[-1] > 0.0


def test_a_steady_load_pushes_at_rest_only_when_it_beats_friction(rotary_simulator):
    loads = [
        disc(coulomb_friction=0.02, effects={"constant_load": {"load_torque_nm": t}}) for t in (0.0199, 0.021)
    ]
    run = commanded([(0.0, 0.0)], seconds=1.0, kind="torque_nm")
    held, moved = (motion(rotary_simulator, plant, run)["angle"] for plant in loads)
    assert np.all(held == 0.0)
    np.testing.assert_allclose(moved, 0.001 / (2.0 * 2e-3) * run.time_s**2, rtol=1e-6, atol=1e-12)


def test_friction_that_differs_by_direction_holds_differently_by_direction(rotary_simulator):
    friction = {"asymmetric_friction": {"coulomb_forward_nm": 0.05, "coulomb_reverse_nm": 0.01}}
    moved = [
        motion(
            rotary_simulator, disc(effects=friction), commanded([(0.0, t)], seconds=0.5, kind="torque_nm")
        )["angle"]
        for t in (0.03, -0.03)
    ]
    assert np.all(moved[0] == 0.0)
    assert moved[1][-1] < -0.5


@pytest.mark.parametrize(("torque_nm", "moves"), [(0.069, 0), (0.071, 1), (-0.029, 0), (-0.031, -1)])
def test_stiction_beside_friction_by_direction_has_one_excess_both_ways(rotary_simulator, torque_nm, moves):
    effects = {
        "asymmetric_friction": {"coulomb_forward_nm": 0.05, "coulomb_reverse_nm": 0.01},
        "stiction": {"breakaway_torque_nm": 0.05, "stribeck_speed_rad_s": 1.0},  # 0.02 above the mean of 0.03
    }
    run = commanded([(0.0, torque_nm)], seconds=0.5, kind="torque_nm")
    angle = motion(rotary_simulator, disc(effects=effects), run)["angle"]
    assert np.sign(angle[-1]) == moves


def test_sliding_friction_takes_the_same_energy_however_fine_the_step(rotary_simulator):
    run = commanded([(0.0, 0.0)], seconds=2.0, kind="torque_nm")
    found = motion(rotary_simulator, disc(coulomb_friction=0.02), run, speed=8.0)
    assert found["angle"][-1] == pytest.approx(0.5 * 2e-3 * 8.0**2 / 0.02, rel=1e-6)
