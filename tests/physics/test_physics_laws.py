"""Each effect against its law written out again, with SciPy as the integrator."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from physics_samples import NXT, commanded, motion, nxt
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

R = NXT["resistance_ohm"]
K = NXT["torque_constant_nm_per_a"]
TC = NXT["coulomb_friction_nm"]
B = NXT["viscous_friction_nm_s_per_rad"]
J = NXT["inertia_kg_m2"]
UB = NXT["supply_v"]

STEPS = ((0.0, 0.3), (0.8, 0.7), (1.6, 0.5))
SECONDS = 2.4
A_FRACTION_OF_A_DEGREE = math.radians(0.2)


class Now(NamedTuple):
    """Where a motor is: command (-1…1), its direction, time, angle and speed."""

    duty: float
    sign: float
    time_s: float
    angle: float
    speed: float

    def drive(self, duty=None, resistance=R, drop=0.0, supply=UB):
        """The motor's torque."""
        volts = supply * (self.duty if duty is None else duty) - K * self.speed
        return K * math.copysign(max(abs(volts) - drop, 0.0), volts) / resistance

    def plain(self):
        """Torque on the inertia without any effect."""
        return self.drive() - B * self.speed - self.sign * TC


# Parameters, and the torque on the inertia while the motor turns in the direction of its command.
LAWS = {
    "none": ({}, lambda m: m.plain()),
    "battery_sag": (
        {"internal_resistance_ohm": 2.0},
        lambda m: m.drive(resistance=R + 2.0 * m.duty**2) - B * m.speed - m.sign * TC,
    ),
    "voltage_drop": ({"drop_v": 0.9}, lambda m: m.drive(drop=0.9) - B * m.speed - m.sign * TC),
    "power_curve": (
        {"exponent": 1.4},
        lambda m: m.drive(duty=m.sign * abs(m.duty) ** 1.4) - B * m.speed - m.sign * TC,
    ),
    "asymmetric_friction": (
        {"coulomb_forward_nm": 0.05, "coulomb_reverse_nm": 0.01},
        lambda m: m.drive() - B * m.speed - (0.05 if m.sign > 0 else -0.01),
    ),
    "asymmetric_viscous_friction": (
        {"viscous_forward_nm_s_per_rad": 5e-3, "viscous_reverse_nm_s_per_rad": 1e-3},
        lambda m: m.drive() - (5e-3 if m.sign > 0 else 1e-3) * m.speed - m.sign * TC,
    ),
    "stiction": (
        {"breakaway_torque_nm": 0.08, "stribeck_speed_rad_s": 2.0, "stribeck_exponent": 1.3},
        lambda m: (
            m.drive() - B * m.speed - m.sign * (TC + (0.08 - TC) * math.exp(-((abs(m.speed) / 2.0) ** 1.3)))
        ),
    ),
    "load_dependent_friction": (
        {"friction_per_torque": 0.3},
        lambda m: m.plain() - m.sign * 0.3 * abs(m.drive()),
    ),
    "torque_saturation": (
        {"torque_yield_per_a": 1.5},
        lambda m: m.plain() + m.drive() * (1.0 / (1.0 + 1.5 * abs(m.drive()) / K) - 1.0),
    ),
    "commutation_ripple": (
        {"ripple_fraction": 0.3, "cycles_per_turn": 6.0, "phase_deg": 20.0},
        lambda m: m.plain() + m.drive() * 0.3 * math.cos(6.0 * m.angle + math.radians(20.0)),
    ),
    "friction_warmup": (
        {"cold_extra_torque_nm": 0.06, "time_constant_s": 1.5},
        lambda m: m.plain() - m.sign * 0.06 * math.exp(-m.time_s / 1.5),
    ),
    "quadratic_drag": (
        {"quadratic_drag_nm_s2_per_rad2": 1e-3},
        lambda m: m.plain() - 1e-3 * m.speed * abs(m.speed),
    ),
    "constant_load": ({"load_torque_nm": 0.03}, lambda m: m.plain() + 0.03),
    "gravity_load": (
        {"gravity_torque_nm": 0.05, "phase_deg": 30.0},
        lambda m: m.plain() - 0.05 * math.sin(m.angle + math.radians(30.0)),
    ),
    "cogging": (
        {"cogging_torque_nm": 0.03, "cycles_per_turn": 6.0, "phase_deg": 40.0},
        lambda m: m.plain() + 0.03 * math.cos(6.0 * m.angle + math.radians(40.0)),
    ),
    "angle_dependent_friction": (
        {"binding_torque_nm": 0.06, "cycles_per_turn": 2.0, "phase_deg": 30.0, "sharpness": 3.0},
        lambda m: m.plain() - m.sign * 0.06 * (0.5 + 0.5 * math.cos(2.0 * m.angle + math.radians(30.0))) ** 3,
    ),
    "battery_drain": (
        {"drain_v_per_s": 0.5},
        lambda m: m.drive(supply=UB - 0.5 * m.time_s) - B * m.speed - m.sign * TC,
    ),
    "spring_load": (
        {"stiffness_nm_per_rad": 2e-3, "rest_angle_deg": 90.0},
        lambda m: m.plain() - 2e-3 * (m.angle - math.pi / 2.0),
    ),
}
SUPERSEDED = {
    "asymmetric_friction": ("coulomb_friction_nm",),
    "asymmetric_viscous_friction": ("viscous_friction_nm_s_per_rad",),
}


def integrated(law, sign, stamps):
    angle = np.zeros(stamps.size)
    state = [0.0, 0.0]
    for (start, level), end in zip(STEPS, [STEPS[1][0], STEPS[2][0], SECONDS], strict=True):
        rows = np.flatnonzero((stamps > start + 1e-9) & (stamps <= end + 1e-9))
        found = solve_ivp(
            lambda t, x, u=sign * level: (x[1], law(Now(u, sign, t, *x)) / J),
            (start, end),
            state,
            method="LSODA",
            t_eval=np.minimum(stamps[rows], end),
            rtol=1e-9,
            atol=1e-9,
        )
        angle[rows], state = found.y[0], found.y[:, -1]
    return angle


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["forward", "reverse"])
@pytest.mark.parametrize("effect_id", LAWS)
def test_a_motor_with_one_effect_moves_by_its_law(motor_simulator, effect_id, sign):
    params, law = LAWS[effect_id]
    effects = {effect_id: params} if params else {}
    plant = nxt(without=("inductance_h", *SUPERSEDED.get(effect_id, ())), effects=effects)
    run = commanded([(t, sign * level) for t, level in STEPS], seconds=SECONDS)
    angle = motion(motor_simulator, plant, run)["angle"]
    expected = integrated(law, sign, run.time_s)
    assert np.abs(angle - expected).max() < A_FRACTION_OF_A_DEGREE
    assert abs(expected[-1]) > 5.0


@pytest.mark.parametrize("knee_a", [0.0, 0.004, 0.03, 0.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_voltage_drop_sets_in_with_the_current(motor_simulator, knee_a, sign):
    def current(volts):
        lost = brentq(
            lambda i: R * i + 0.9 * i / (i + knee_a + 1e-12) - abs(volts), 0.0, abs(volts) / R + 1e-9
        )
        return math.copysign(lost, volts)

    plant = nxt(without=("inductance_h",), effects={"voltage_drop": {"drop_v": 0.9, "drop_knee_a": knee_a}})
    run = commanded([(t, sign * level) for t, level in STEPS], seconds=SECONDS)
    angle = motion(motor_simulator, plant, run)["angle"]
    expected = integrated(
        lambda m: K * current(UB * m.duty - K * m.speed) - B * m.speed - m.sign * TC, sign, run.time_s
    )
    assert np.abs(angle - expected).max() < A_FRACTION_OF_A_DEGREE


@pytest.mark.parametrize("duty", [-1.0, -0.4, 0.1, 0.55, 1.0])
def test_steady_speed_is_that_of_equation_11(motor_simulator, duty):
    speed = motion(motor_simulator, nxt(), commanded([(0.0, duty)], seconds=3.0))["speed"][-1]
    volts = abs(duty) * UB
    expected = (volts - R * TC / K) / (R * B / K + K)
    assert speed == pytest.approx(math.copysign(expected, duty), rel=1e-6)


def test_current_in_a_held_rotor_rises_with_the_winding_s_time_constant(motor_simulator):
    plant = nxt(inductance_h=0.05, coulomb_friction_nm=2.0)
    run = commanded([(0.0, 0.5)], seconds=0.05, every_s=1e-3)
    expected = 0.5 * UB / R * (1.0 - np.exp(-run.time_s * R / 0.05))
    np.testing.assert_allclose(motion(motor_simulator, plant, run)["current"], expected, atol=2e-3)


def test_a_current_limit_bounds_the_acceleration(motor_simulator):
    plant = nxt(without=("inductance_h", "viscous_friction_nm_s_per_rad"), current_limit_a=0.3)
    run = commanded([(0.0, 1.0)], seconds=0.05)
    found = motion(motor_simulator, plant, run)
    np.testing.assert_allclose(found["speed"], (K * 0.3 - TC) / J * run.time_s, rtol=1e-9)
    assert found["current"].max() == pytest.approx(0.3)


def test_a_voltage_beyond_the_supply_acts_as_the_supply(motor_simulator):
    by_volts = [commanded([(0.0, level)], seconds=0.5, kind="voltage_v", mode=4) for level in (8.0, 20.0)]
    whole, beyond = (motion(motor_simulator, nxt(), run)["angle"] for run in by_volts)
    np.testing.assert_array_equal(whole, beyond)
    full = motion(motor_simulator, nxt(), commanded([(0.0, 1.0)], seconds=0.5))["angle"]
    np.testing.assert_array_equal(whole, full)


def test_a_given_current_gives_its_torque_whatever_the_speed(motor_simulator):
    plant = nxt(without=("inductance_h", "viscous_friction_nm_s_per_rad"))
    run = commanded([(0.0, 0.2)], seconds=0.5, kind="current_a", mode=5)
    speed = motion(motor_simulator, plant, run)["speed"]
    np.testing.assert_allclose(speed, (K * 0.2 - TC) / J * run.time_s, rtol=1e-9)


def test_float_mode_drives_only_while_the_bridge_conducts(motor_simulator):
    run = commanded([(0.0, 0.4)], seconds=3.0, mode=1)
    speed = motion(motor_simulator, nxt(), run)["speed"][-1]
    assert speed == pytest.approx((0.4 * K * UB / R - TC) / (B + 0.4 * K * K / R), rel=1e-6)


def test_a_braked_motor_stops_on_its_shorted_winding(motor_simulator):
    plant = nxt(without=("inductance_h", "coulomb_friction_nm"))
    run = commanded([(0.0, 0.0)], seconds=0.2, mode=3)
    speed = motion(motor_simulator, plant, run, speed=12.0)["speed"]
    np.testing.assert_allclose(speed, 12.0 * np.exp(-(B + K * K / R) / J * run.time_s), rtol=1e-3)


def test_a_coasting_motor_runs_down_by_friction_alone_and_stops_for_good(motor_simulator):
    run = commanded([(0.0, 0.0)], seconds=2.0, mode=2)
    found = motion(motor_simulator, nxt(), run, speed=10.0)
    expected = np.maximum((10.0 + TC / B) * np.exp(-B / J * run.time_s) - TC / B, 0.0)
    np.testing.assert_allclose(found["speed"], expected, atol=2e-3)
    stops_s = J / B * math.log(1.0 + 10.0 * B / TC)
    assert np.all(found["speed"][run.time_s > stops_s + 2e-3] == 0.0)
    assert np.all(found["current"] == 0.0)
