"""Each concealed effect does what docs/effects.md says of it, with its parameters' meaning."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nxt_twin.blind.truth.integrator import CURRENT, HEAT, MISCOUNT, OMEGA, OMEGA_LOAD, THETA, THETA_LOAD
from nxt_twin.blind.truth.motor import Motor
from nxt_twin.blind.truth.run import Commands, true_run
from nxt_twin.blind.truth.sensing import Sensing, hold_stale

DRIVE, FLOAT, COAST, BRAKE = range(4)
PLAIN = Motor()
BLOCKED = {"inertia_kg_m2": 1e3}


def steady_speed(
    volts: float,
    *,
    resistance: float = 7.6,
    drop_v: float = 0.0,
    coulomb: float = 8.45e-3,
    share: float = 1.0,
) -> float:
    """Speed at which the torque left after load-dependent friction balances Coulomb and viscous friction."""
    ks, b = PLAIN.torque_constant_nm_per_a, PLAIN.viscous_friction_nm_s_per_rad
    return (volts - drop_v - resistance * coulomb / (ks * share)) / (resistance * b / (ks * share) + ks)


def breakaway_duty(torque_nm: float) -> float:
    return torque_nm * PLAIN.resistance_ohm / PLAIN.torque_constant_nm_per_a / PLAIN.battery_v


def stepped(rows: int = 300, *, power_pct: float = 80.0, from_row: int = 50) -> Commands:
    power = np.where(np.arange(rows) < from_row, 0.0, power_pct)
    return Commands(np.arange(rows) * 0.01, power, np.zeros(rows, dtype=np.int64), 0.0, 0.0, np.zeros(rows))


def test_viscous_friction_sets_how_fast_a_coasting_motor_slows(drive):
    frictionless = Motor(coulomb_forward_nm=0.0, coulomb_reverse_nm=0.0)
    speed = drive(frictionless, 0.0, 0.5, mode=COAST, speed=10.0)[-1, OMEGA]
    assert speed == pytest.approx(10.0 * math.exp(-0.5 * 1.92e-3 / 1.2e-3), rel=1e-4)


def test_presliding_bends_by_its_angle_and_springs_back(drive):
    motor = Motor(bristle_reach_rad=math.radians(10.0), bristle_exponent=1.0)
    duty = np.where(np.arange(12001) < 6000, breakaway_duty(0.6 * motor.coulomb_forward_nm), 0.0)
    angle_deg = np.rad2deg(drive(motor, duty, 12.0)[:, THETA])
    # Dahl: the friction after a displacement x is 1 - exp(-x / reach) of Coulomb friction
    assert angle_deg[6000] == pytest.approx(-10.0 * math.log(0.4), rel=0.05)
    assert angle_deg[-1] < 0.6 * angle_deg[6000]


def test_stiction_holds_up_to_the_whole_breakaway_torque(drive):
    motor = Motor(stiction_excess_nm=0.02, stribeck_speed_rad_s=1.0)
    held = drive(motor, breakaway_duty(0.9 * (0.02 + 8.45e-3)), 3.0)
    gone = drive(motor, breakaway_duty(1.1 * (0.02 + 8.45e-3)), 3.0)
    assert abs(held[-1, THETA]) < math.radians(1.0)
    assert gone[-1, OMEGA] > 0.1


@pytest.mark.parametrize("exponent", [0.0, 1.0, 1.5, 2.0])
def test_stiction_is_gone_far_above_the_stribeck_speed(drive, exponent):
    motor = Motor(stiction_excess_nm=0.02, stribeck_speed_rad_s=0.5, stribeck_exponent=exponent)
    assert drive(motor, 1.0, 1.0)[-1, OMEGA] == pytest.approx(steady_speed(8.0), rel=2e-3)


def test_asymmetric_friction_gives_each_direction_its_own_level(drive):
    motor = Motor(coulomb_forward_nm=0.03, coulomb_reverse_nm=0.01)
    assert drive(motor, 0.5, 1.0)[-1, OMEGA] == pytest.approx(steady_speed(4.0, coulomb=0.03), rel=1e-3)
    assert drive(motor, -0.5, 1.0)[-1, OMEGA] == pytest.approx(-steady_speed(4.0, coulomb=0.01), rel=1e-3)


def test_load_dependent_friction_takes_its_share_of_the_torque(drive):
    motor = Motor(friction_per_torque=0.3)
    assert drive(motor, 0.5, 2.0)[-1, OMEGA] == pytest.approx(steady_speed(4.0, share=0.7), rel=1e-3)


def test_quadratic_drag_balances_the_rest_of_the_torque(drive):
    motor = Motor(quadratic_drag_nm_s2_per_rad2=5e-4)
    x = drive(motor, 1.0, 1.0)[-1]
    rest = PLAIN.torque_constant_nm_per_a * x[CURRENT] - 8.45e-3 - 1.92e-3 * x[OMEGA]
    assert rest == pytest.approx(5e-4 * x[OMEGA] ** 2, rel=1e-3)


def test_friction_warmup_decays_with_its_time_constant(drive):
    speeds = drive(Motor(cold_extra_torque_nm=0.03, warmup_time_s=1.0), 0.8, 3.0)[:, OMEGA]
    for at_s in (1.0, 3.0):
        expected = steady_speed(6.4, coulomb=8.45e-3 + 0.03 * math.exp(-at_s))
        assert speeds[round(1000 * at_s)] == pytest.approx(expected, rel=5e-3)


def test_angle_dependent_friction_binds_so_many_times_a_turn(drive):
    x = drive(Motor(binding_torque_nm=0.05, binding_cycles=2.0, binding_sharpness=2.0), 0.4, 6.0)[3000:]
    slow = np.sum(np.diff(np.sign(x[:, OMEGA] - x[:, OMEGA].mean())) < 0)
    turns = (x[-1, THETA] - x[0, THETA]) / (2.0 * math.pi)
    assert slow == pytest.approx(2.0 * turns, abs=1.0)


def test_backlash_lets_the_load_lag_by_half_the_gap_on_each_side(drive):
    motor = Motor(gap_rad=math.radians(8.0), load_inertia_kg_m2=1e-3)
    duty = np.where(np.arange(2001) % 1000 < 500, 0.6, -0.6)
    x = drive(motor, duty, 2.0)
    play_deg = np.rad2deg(x[:, THETA] - x[:, THETA_LOAD])
    assert play_deg.max() == pytest.approx(4.0, abs=0.6)
    assert play_deg.min() == pytest.approx(-4.0, abs=0.6)


def test_shaft_compliance_swings_at_the_two_mass_frequency(drive):
    hub, load, stiffness = 1.2e-3, 1e-3, 1.0
    motor = Motor(
        load_inertia_kg_m2=load,
        shaft_stiffness_nm_per_rad=stiffness,
        coulomb_forward_nm=0.0,
        coulomb_reverse_nm=0.0,
        viscous_friction_nm_s_per_rad=0.0,
        constant_torque_nm=0.01,
    )
    x = drive(motor, 0.0, 2.0, mode=COAST)
    twist = x[:, THETA] - x[:, THETA_LOAD]
    swings = np.sum(np.diff(np.sign(twist - twist.mean())) != 0) / 2.0
    assert swings / 2.0 == pytest.approx(
        math.sqrt(stiffness * (1 / hub + 1 / load)) / (2.0 * math.pi), abs=0.3
    )


def test_an_unbalanced_arm_comes_to_rest_hanging(drive):
    motor = Motor(arm_mass_kg=0.05, arm_length_m=0.1, arm_phase_rad=math.radians(30.0))
    end_deg = math.degrees(drive(motor, 0.0, 6.0, mode=COAST, start_deg=70.0)[-1, THETA])
    slack_deg = math.degrees(math.asin(8.45e-3 / (0.05 * 9.81 * 0.1)))
    assert abs(end_deg + 30.0) < slack_deg + 0.2


def test_cogging_pulls_the_hub_into_one_of_its_detents(drive):
    motor = Motor(cogging_torque_nm=0.05, cogging_cycles=4.0)
    end_deg = math.degrees(drive(motor, 0.0, 4.0, mode=COAST, start_deg=20.0)[-1, THETA])
    slack_deg = math.degrees(math.asin(8.45e-3 / 0.05)) / 4.0
    assert abs(end_deg - 45.0) < slack_deg + 0.2


def test_payload_slows_the_start_from_its_time_on(drive):
    duty = np.where(np.arange(1001) % 500 < 100, 0.5, 0.0)
    x = drive(Motor(added_inertia_kg_m2=1.2e-3, added_from_s=0.45), duty, 1.0)
    assert x[520, OMEGA] == pytest.approx(0.6 * x[20, OMEGA], rel=0.1)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_end_stop_is_never_passed_by_a_degree(drive, side):
    motor = Motor(stop_side=side, stop_rad=side * math.radians(200.0))
    x = drive(motor, side * 1.0, 1.5)
    outward_deg = side * np.rad2deg(x[:, THETA])
    assert outward_deg.max() < 201.0
    assert outward_deg[-1] == pytest.approx(200.0, abs=0.3)


def test_constant_load_pulls_a_coasting_hub(drive):
    x = drive(Motor(constant_torque_nm=0.03), 0.0, 0.1, mode=COAST)
    assert x[-1, OMEGA] == pytest.approx((0.03 - 8.45e-3) / 1.2e-3 * 0.1, rel=0.1)


def test_a_small_constant_load_is_held_by_friction(drive):
    assert abs(drive(Motor(constant_torque_nm=6e-3), 0.0, 5.0, mode=COAST)[-1, THETA]) < math.radians(0.1)


def test_spring_load_brings_a_coasting_hub_to_its_rest_angle(drive):
    motor = Motor(band_stiffness_nm_per_rad=0.05, band_rest_rad=math.radians(90.0))
    end_deg = math.degrees(drive(motor, 0.0, 5.0, mode=COAST)[-1, THETA])
    assert abs(end_deg - 90.0) < math.degrees(8.45e-3 / 0.05) + 0.2


def test_inductance_delays_the_current_by_its_time_constant(drive):
    x = drive(Motor(inductance_h=7.6 * 0.04, **BLOCKED), 0.5, 0.04)
    assert x[-1, CURRENT] == pytest.approx(4.0 / 7.6 * (1.0 - math.exp(-1.0)), rel=1e-3)


def test_battery_sag_counts_the_duty_twice(drive):
    motor = Motor(internal_resistance_ohm=2.0)
    expected = steady_speed(4.0, resistance=7.6 + 2.0 * 0.5**2)
    assert drive(motor, 0.5, 1.0)[-1, OMEGA] == pytest.approx(expected, rel=1e-3)


def test_battery_drain_lowers_the_speed_as_time_goes_by(drive):
    speeds = drive(Motor(drain_v_per_s=0.2), 1.0, 5.0)[:, OMEGA]
    assert speeds[5000] == pytest.approx(steady_speed(7.0), rel=5e-3)


def test_winding_heats_by_the_joules_put_in(drive):
    x = drive(Motor(resistance_rise_per_joule=0.01, thermal_time_s=1e4, **BLOCKED), 1.0, 2.0)
    assert x[-1, CURRENT] == pytest.approx(8.0 / (7.6 * (1.0 + x[-1, HEAT])), rel=1e-3)
    joules = np.trapezoid(7.6 * x[:, CURRENT] ** 2, dx=1e-3)
    assert x[-1, HEAT] == pytest.approx(0.01 * joules, rel=1e-2)


def test_current_limit_caps_the_current(drive):
    assert drive(Motor(current_limit_a=0.4, **BLOCKED), 1.0, 0.5)[-1, CURRENT] == pytest.approx(0.4, abs=0.03)


def test_voltage_drop_is_lost_at_all_speeds(drive):
    motor = Motor(drop_v=1.0)
    for duty in (0.5, 1.0):
        expected = steady_speed(8.0 * duty, drop_v=1.0)
        assert drive(motor, duty, 1.0)[-1, OMEGA] == pytest.approx(expected, rel=1e-2)


def test_power_curve_bends_duty():
    hub_deg = true_run(Motor(power_exponent=1.5), Sensing(), stepped(power_pct=50.0)).hub_deg
    speed = math.radians(hub_deg[-1] - hub_deg[-2]) / 0.01
    assert speed == pytest.approx(steady_speed(8.0 * 0.5**1.5), rel=1e-3)


def test_command_delay_makes_the_first_movement_later_by_it():
    prompt = true_run(Motor(), Sensing(), stepped()).hub_deg
    late = true_run(Motor(), Sensing(delay_s=0.03), stepped()).hub_deg
    np.testing.assert_allclose(late[3:], prompt[:-3], atol=1e-6)
    assert np.all(late[:54] < 0.5)


def test_clock_skew_stretches_the_stamps_and_lets_them_lag():
    commands = stepped(rows=1000)
    sensing = Sensing(rate_error=0.01, lag_span_s=0.05, lag_period_s=3.0)
    late_s = true_run(Motor(), sensing, commands).stamp_s / 1.01 - commands.read_s
    assert late_s.min() == pytest.approx(0.0, abs=1e-3)
    assert late_s.max() == pytest.approx(0.05, abs=1e-3)


def test_stale_rows_repeat_the_reading_before():
    fresh = np.arange(6.0)
    stale = np.array([False, True, False, True, True, False])
    np.testing.assert_array_equal(hold_stale(fresh, stale), [0.0, 0.0, 2.0, 2.0, 2.0, 5.0])


def test_missed_counts_go_missing_above_the_threshold_only(drive):
    motor = Motor(lost_fraction=0.1, lost_above_rad_s=8.0)
    slow, fast = drive(motor, 0.3, 1.0), drive(motor, 1.0, 1.0)
    assert abs(slow[-1, MISCOUNT]) < 1e-6
    lost = (fast[-1, MISCOUNT] - fast[500, MISCOUNT]) / (fast[-1, THETA] - fast[500, THETA])
    assert lost == pytest.approx(-0.1, rel=1e-3)


def test_eccentric_encoder_errs_by_its_amplitude_once_a_turn():
    run = true_run(Motor(), Sensing(eccentricity_deg=3.0), stepped())
    error_deg = run.encoder_deg - run.hub_deg
    assert np.abs(error_deg).max() == pytest.approx(3.0, rel=1e-2)
    np.testing.assert_allclose(error_deg, 3.0 * np.sin(np.deg2rad(run.hub_deg)), atol=1e-9)


def test_sagging_battery_is_read_at_its_terminals():
    run = true_run(Motor(internal_resistance_ohm=2.0, **BLOCKED), Sensing(), stepped())
    assert run.terminal_v[0] == 8.0
    assert run.terminal_v[-1] == pytest.approx(8.0 * (1.0 - 2.0 * 0.8**2 / (7.6 + 2.0 * 0.8**2)), rel=1e-3)


def test_load_behind_a_gap_is_carried_along(drive):
    motor = Motor(gap_rad=math.radians(5.0), load_inertia_kg_m2=1e-3)
    x = drive(motor, 0.5, 2.0)
    assert x[-1, OMEGA_LOAD] == pytest.approx(x[-1, OMEGA], rel=0.05)
