"""Dry friction holds exactly: nothing starts before its breakaway, and only smoothed friction creeps."""

from dataclasses import replace

import numpy as np
import pytest
from physics_samples import NXT, commanded, disc, motion, nxt
from scipy.integrate import solve_ivp

from nxt_twin.physics.simulate import free_job
from nxt_twin.physics.start import at_rest

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


@pytest.mark.parametrize("creep_speed", [0.02, 0.2])
@pytest.mark.parametrize("step_s", [1e-3, 4e-3])
def test_smoothed_friction_creeps_below_sliding_by_its_own_law(rotary_simulator, creep_speed, step_s):
    """The law again, integrated by SciPy: pushed below sliding, above it, back, and let go."""
    levels = [(0.0, 0.012), (1.0, 0.06), (1.3, -0.018), (2.2, 0.0)]
    friction = {"coulomb_friction": 0.02, "viscous_friction": 5e-3}
    plant = disc(**friction, effects={"friction_creep": {"creep_speed_rad_s": creep_speed}})
    run = commanded(levels, seconds=3.0, kind="torque_nm")

    def rates(t, x):
        torque = [level for at, level in levels if at <= t][-1]
        braked = 0.02 * np.tanh(x[1] / creep_speed) + 5e-3 * x[1]
        return x[1], (torque - braked) / 2e-3

    state, expected = [0.0, 0.0], np.zeros(run.time_s.size)
    for (low, _), high in zip(levels, [1.0, 1.3, 2.2, 3.0], strict=True):
        rows = np.flatnonzero((run.time_s > low + 1e-9) & (run.time_s <= high + 1e-9))
        stamps = np.minimum(run.time_s[rows], high - 1e-12)
        found = solve_ivp(rates, (low, high - 1e-12), state, "Radau", t_eval=stamps, rtol=1e-8, atol=1e-10)
        expected[rows], state = found.y[0], found.y[:, -1]
    angle = rotary_simulator.trace(plant, replace(free_job(run, at_rest(run)), step_s=step_s))["angle"]
    assert np.abs(angle - expected).max() < 2e-3 + 4.0 * step_s
    assert expected[run.time_s < 1.0].max() > 0.5 * creep_speed
