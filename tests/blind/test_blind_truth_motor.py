from __future__ import annotations

import ast
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import njit

import nxt_twin.blind.truth
from nxt_twin.blind.truth import integrator
from nxt_twin.blind.truth.integrator import BEND, CURRENT, OMEGA, THETA
from nxt_twin.blind.truth.motor import Motor

DRIVE, FLOAT, COAST, BRAKE = range(4)
TRUTH_FOLDER = Path(nxt_twin.blind.truth.__file__).parent
MAY_IMPORT = (
    "nxt_twin.blind.truth",
    "nxt_twin.recording",
    "nxt_twin.errors",
    "nxt_twin.arrays",
    "nxt_twin.machine_code",
)


def steady_speed(motor: Motor, volts: float) -> float:
    """Equation 11 of the paper."""
    ra, ks, tc = motor.resistance_ohm, motor.back_emf_v_s_per_rad, motor.coulomb_forward_nm
    return (volts - ra * tc / ks) / (ra * motor.viscous_friction_nm_s_per_rad / ks + ks)


@pytest.mark.parametrize("duty", [0.15, 0.5, 1.0])
def test_clean_motor_runs_at_the_speed_of_equation_11(drive, duty):
    motor = Motor()
    assert drive(motor, duty, 1.0)[-1, OMEGA] == pytest.approx(steady_speed(motor, 8.0 * duty), rel=1e-3)


def test_clean_motor_runs_alike_in_both_directions(drive):
    np.testing.assert_allclose(drive(Motor(), -0.6, 0.5), -drive(Motor(), 0.6, 0.5), atol=1e-9)


def test_friction_holds_the_motor_within_a_tenth_of_a_degree_below_breakaway(drive):
    motor = Motor()
    breakaway_duty = motor.coulomb_forward_nm * motor.resistance_ohm / motor.torque_constant_nm_per_a / 8.0
    assert np.abs(drive(motor, 0.9 * breakaway_duty, 10.0)[:, THETA]).max() < math.radians(0.1)
    assert drive(motor, 1.5 * breakaway_duty, 2.0)[-1, THETA] > math.radians(10.0)


def test_braking_stops_sooner_than_coasting(drive):
    braked = drive(Motor(), 0.0, 2.0, mode=BRAKE, speed=12.0)
    coasting = drive(Motor(), 0.0, 2.0, mode=COAST, speed=12.0)
    assert braked[-1, THETA] < 0.2 * coasting[-1, THETA]


def test_coasting_draws_no_current(drive):
    assert np.abs(drive(Motor(), 0.7, 0.2, mode=COAST, speed=12.0)[:, CURRENT]).max() == 0.0


def test_open_off_phase_lets_current_flow_only_forwards(drive):
    faster_than_supply = Motor().battery_v / Motor().back_emf_v_s_per_rad + 1.0
    assert drive(Motor(), 0.5, 0.01, mode=FLOAT, speed=faster_than_supply)[-1, CURRENT] == 0.0
    assert drive(Motor(), 0.5, 0.05, mode=FLOAT)[-1, CURRENT] > 0.1


def test_open_off_phase_reaches_nearly_full_speed_at_half_duty(drive):
    half = drive(Motor(), 0.5, 2.0, mode=FLOAT)[-1, OMEGA]
    assert half > 0.9 * steady_speed(Motor(), 8.0)


def test_motor_never_gains_energy_without_a_battery(drive):
    motor = Motor(shaft_stiffness_nm_per_rad=0.4, load_inertia_kg_m2=1e-3)
    x = drive(motor, 0.0, 1.0, mode=COAST, speed=10.0)
    stiffness = motor.coulomb_forward_nm / motor.bristle_reach_rad
    energy_j = (
        0.5 * motor.inertia_kg_m2 * x[:, OMEGA] ** 2
        + 0.5 * motor.load_inertia_kg_m2 * x[:, 5] ** 2
        + 0.5 * motor.shaft_stiffness_nm_per_rad * (x[:, THETA] - x[:, 4]) ** 2
        + 0.5 * stiffness * x[:, BEND] ** 2
    )
    assert np.all(np.diff(energy_j) < 1e-9)
    assert energy_j[-1] < 0.7 * energy_j[0]


@pytest.mark.slow
def test_a_shorter_time_step_changes_nothing_visible(drive, monkeypatch):
    motor = Motor(stiction_excess_nm=0.02, drop_v=0.5)
    duty = 0.4 * np.sin(np.arange(1001) / 60.0)
    usual_rad = drive(motor, duty, 1.0)[:, THETA]
    # the events are a millisecond apart: 40 usual steps, or 62.5 -> 63 of the shorter ones
    finer = integrator.integrate.py_func
    monkeypatch.setattr(integrator, "LONGEST_STEP_S", 16e-6)
    monkeypatch.setattr(integrator, "integrate", njit(finer))
    np.testing.assert_allclose(drive(motor, duty, 1.0)[:, THETA], usual_rad, atol=math.radians(0.01))


def test_truth_imports_nothing_of_the_fitting_side():
    files = sorted(TRUTH_FOLDER.glob("*.py"))
    assert len(files) > 5
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0
                names = [node.module or ""]
            for name in names:
                assert not name.startswith("nxt_twin") or name.startswith(MAY_IMPORT), (file.name, name)


def test_loading_the_benchmark_loads_no_fitting_code():
    code = (
        "import sys, nxt_twin.blind.make, nxt_twin.blind.score\n"
        "print([m for m in sys.modules if m.startswith(('nxt_twin.physics', 'nxt_twin.diagnose'))])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
