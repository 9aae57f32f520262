"""The covariance of a motor's fit, held against what the fit does on recordings of many brick-like motors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nxt_twin.diagnose.engine import problem_for
from nxt_twin.diagnose.fitting.everything import fit_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.linear import Linear, linearise
from nxt_twin.diagnose.fitting.noise import first_noise
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.experiment.replicates import fit_covariance
from nxt_twin.physics.simulate import STEP_S, Simulator
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

Fit = tuple[Simulator, Linear, Target]

SURE = {f"run{n}.csv": 0.0 for n in range(3)}

MOTOR = {
    "kind": "dc_motor",
    "resistance_ohm": 7.6,
    "inductance_h": 4.88e-3,
    "torque_constant_nm_per_a": 0.49,
    "back_emf_v_s_per_rad": 0.49,
    "coulomb_friction_nm": 0.01,
    "viscous_friction_nm_s_per_rad": 1.9e-3,
    "inertia_kg_m2": 1.2e-3,
}


def a_run(rng: np.random.Generator, number: int) -> Recording:
    """A second of driving and half a second of coasting by a closed-form motor without inductance, cut to counts."""
    time_s = np.arange(0.0, 1.5, 0.01)
    constant, resistance, inertia = 0.49, 7.6, 1.2e-3
    damping = (constant**2 / resistance + 1.9e-3) / inertia
    final = (constant * 8.0 / resistance - 0.01) / inertia / damping
    driven = np.clip(time_s - 0.05, 0.0, 1.0)
    angle = final * (driven - (1.0 - np.exp(-damping * driven)) / damping)
    speed = final * (1.0 - np.exp(-damping))
    rate, slowing = 1.9e-3 / inertia, 0.01 / inertia
    coasted = np.clip(time_s - 1.05, 0.0, None)
    angle += (speed + slowing / rate) * -np.expm1(-rate * coasted) / rate - slowing * coasted / rate
    driving = (time_s >= 0.05 - 1e-9) & (time_s < 1.05 - 1e-9)
    columns = {
        "time_s": time_s,
        "a_power_pct": np.where(driving, 100.0, 0.0),
        "a_mode": np.where(driving, 0.0, 2.0),
        "a_tacho_deg": np.floor(np.degrees(angle) + rng.random()),
        "battery_v": np.full(time_s.size, 8.0),
    }
    return Recording(f"run{number}.csv", columns)


def fitted(seed: int) -> Fit:
    rng = np.random.default_rng(seed)
    plant = {key: value for key, value in MOTOR.items() if key != "inductance_h"}
    problem = problem_for(Case("c", Path(), plant, tuple(a_run(rng, n) for n in range(3)), (), "a"))
    simulator = Simulator(problem.plant.layout)
    structure = fit_everything(
        Fitter(simulator, problem),
        problem.plant,
        first_noise(problem.plant, problem.signals, problem.scale.torque),
    )
    return simulator, linearise(simulator, problem, structure, STEP_S), problem.everything()


@pytest.fixture(scope="module")
def one() -> Fit:
    return fitted(0)


def stds(covariance: np.ndarray) -> np.ndarray:
    return np.sqrt(np.diag(covariance))


def test_the_covariance_does_not_hang_on_which_made_up_recordings_were_drawn(
    one: Fit,
) -> None:
    several = [stds(fit_covariance(*one, SURE, np.random.default_rng(seed))) for seed in range(4)]
    assert np.all(np.ptp(several, axis=0) < 0.3 * np.mean(several, axis=0))


def test_a_wilder_unknown_torque_makes_every_doubt_larger(one: Fit) -> None:
    simulator, linear, target = one
    wilder = replace(linear.structure.noise, disturbance_std=5.0)
    stormy = replace(linear, structure=replace(linear.structure, noise=wilder))
    calm = stds(fit_covariance(simulator, linear, target, SURE, np.random.default_rng(0)))
    wild = stds(fit_covariance(simulator, stormy, target, SURE, np.random.default_rng(0)))
    assert np.all(wild > 1.5 * calm)


def test_a_link_of_which_nobody_knows_when_it_hands_commands_on_makes_every_doubt_larger(one: Fit) -> None:
    late = dict.fromkeys(SURE, 5e-3)
    sure, doubtful = (stds(fit_covariance(*one, lags, np.random.default_rng(0))) for lags in (SURE, late))
    assert np.all(doubtful > 1.2 * sure)


def test_errors_of_a_motor_worked_out_by_hand_are_as_large_as_the_covariance_says() -> None:
    """K is told by voltage and angle alone, and is one of the variables."""
    errors = []
    for seed in range(12):
        simulator, linear, target = fitted(seed)
        symbols = [variable.slots[0].symbol for variable in linear.variables]
        index = symbols.index("torque_constant")
        slot = linear.variables[index].slots[0]
        std = stds(fit_covariance(simulator, linear, target, SURE, np.random.default_rng(seed)))[index]
        errors.append((linear.structure.plant.values[slot] - 0.49) / std)
    assert 0.2 < float(np.sqrt(np.mean(np.square(errors)))) < 2.0
