from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from blind_numbers import PLAIN
from scipy.integrate import solve_ivp

from nxt_twin.blind.families.mujoco.machine import MuJoCo

pytest.importorskip("mujoco")

STOPS_S = np.linspace(0.02, 1.0, 50)


def oracle(motor, duty, load=lambda _: 0.0, start=0.0, speed_sign=1.0):
    def rates(_, x):
        theta, omega, current = x
        volts = (
            duty * motor.supply_v - motor.torque_constant_nm_per_a * omega - motor.resistance_ohm * current
        )
        torque = motor.torque_constant_nm_per_a * current - motor.viscous_friction_nm_s_per_rad * omega
        torque += load(theta) - speed_sign * motor.coulomb_nm
        return [omega, torque / motor.inertia_kg_m2, volts / motor.inductance_h]

    done = solve_ivp(rates, (0.0, 1.0), [start, 0.0, 0.0], t_eval=STOPS_S, rtol=1e-8, atol=1e-10)
    return done.y[0]


def test_a_driven_motor_turns_as_its_equations_say():
    hub_rad = MuJoCo(PLAIN, 0.0).run(STOPS_S, 0.6, 0)[:, 0]
    np.testing.assert_allclose(hub_rad, oracle(PLAIN, 0.6), atol=np.deg2rad(0.6))


def test_a_hanging_arm_pulls_with_the_sine_of_the_angle_and_the_motors_inertia_stays():
    motor = replace(PLAIN, gravity_torque_nm=0.06, gravity_phase_rad=0.7)
    hub_rad = MuJoCo(motor, 0.2).run(STOPS_S, 0.6, 0)[:, 0]
    expected = oracle(motor, 0.6, load=lambda theta: -0.06 * np.sin(theta + 0.7), start=0.2)
    np.testing.assert_allclose(hub_rad, expected, atol=np.deg2rad(0.8))


def test_more_inertia_from_some_time_on_is_felt_from_then_on():
    early = MuJoCo(replace(PLAIN, added_inertia_kg_m2=2e-3, added_from_s=0.0), 0.0).run(STOPS_S, 0.6, 0)[:, 0]
    heavier = oracle(replace(PLAIN, inertia_kg_m2=3.2e-3), 0.6)
    np.testing.assert_allclose(early, heavier, atol=np.deg2rad(0.8))
    never = MuJoCo(replace(PLAIN, added_inertia_kg_m2=2e-3), 0.0).run(STOPS_S, 0.6, 0)[:, 0]
    np.testing.assert_allclose(never, oracle(PLAIN, 0.6), atol=np.deg2rad(0.6))


def test_friction_holds_up_to_its_level_and_no_further():
    below, above = (
        torque * PLAIN.resistance_ohm / (PLAIN.torque_constant_nm_per_a * PLAIN.supply_v)
        for torque in (7e-3, 14e-3)
    )
    assert abs(MuJoCo(PLAIN, 0.0).run(STOPS_S, below, 0)[-1, 0]) < np.deg2rad(0.1)
    assert MuJoCo(PLAIN, 0.0).run(STOPS_S, above, 0)[-1, 0] > np.deg2rad(5.0)


def test_a_stop_holds_the_hub_at_its_limit():
    motor = replace(PLAIN, stop_side=1.0, stop_rad=2.0)
    hub_rad = MuJoCo(motor, 0.0).run(STOPS_S, 0.6, 0)[:, 0]
    assert hub_rad[-1] == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_a_load_bears_its_share_of_the_friction_and_adds_none(share):
    motor = replace(PLAIN, load_inertia_kg_m2=6e-4, gap_rad=np.deg2rad(1.0), share=share)
    hub_rad = MuJoCo(motor, 0.0).run(STOPS_S, 0.6, 0)[:, 0]
    steady, plain = (np.diff(rad[-10:]).mean() for rad in (hub_rad, oracle(PLAIN, 0.6)))
    assert steady == pytest.approx(plain, rel=0.01)


def test_a_load_behind_play_is_taken_along_once_the_play_is_used_up():
    motor = replace(PLAIN, load_inertia_kg_m2=1.2e-3, gap_rad=np.deg2rad(16.0))
    hub_rad = MuJoCo(motor, 0.0).run(STOPS_S, 0.6, 0)[:, 0]
    alone, together = oracle(PLAIN, 0.6), oracle(replace(PLAIN, inertia_kg_m2=2.4e-3), 0.6)
    np.testing.assert_allclose(hub_rad[0], alone[0], atol=np.deg2rad(0.3))
    assert together[-1] < hub_rad[-1] < alone[-1]
