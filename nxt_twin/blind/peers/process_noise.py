"""A likelihood-ratio test on process noise in the manner of CTSM: does the torque balance lack something."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy import stats
from scipy.optimize import minimize

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import compiled
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

LEVEL: Final = 0.05
SLOW_RAD_S: Final = 0.05
QUIET: Final = -6.0
"""Logarithm of the process noise (rad/s per root s) that stands for none."""
MOST_TRIALS: Final = 500


def lacks_something(case: Case) -> bool:
    """Whether noise on the speed makes the readings likelier than half a chi-squared of one degree allows.

    An extended Kalman filter of angle and speed carries the plain motor (drive, damping, dry friction). It
    fits all parameters and the reading's noise twice: with and without noise on the speed.
    """
    plant = case.plant if isinstance(case.plant, dict) else {}
    inertia = float(plant["inertia_kg_m2"])
    constant, ohm = float(plant["torque_constant_nm_per_a"]), float(plant["resistance_ohm"])
    damping = constant**2 / ohm + float(plant.get("viscous_friction_nm_s_per_rad", 0.0))
    dry = max(float(plant.get("coulomb_friction_nm", 0.0)), 1e-4)
    runs = [_run(recording, float(plant.get("supply_v", 8.0))) for recording in case.recordings]
    start = np.log([constant / (ohm * inertia), damping / inertia, dry / inertia, np.deg2rad(0.4)])

    def without(logs: FloatArray) -> float:
        return sum(_surprise(np.append(logs, QUIET), *run) for run in runs)

    def with_noise(logs: FloatArray) -> float:
        return sum(_surprise(logs, *run) for run in runs)

    options = {"maxfev": MOST_TRIALS, "xatol": 1e-3, "fatol": 1e-2}
    bare = minimize(without, start, method="Nelder-Mead", options=options)
    free = minimize(with_noise, np.append(bare.x, 0.0), method="Nelder-Mead", options=options)
    ratio = 2.0 * (bare.fun - free.fun)
    return bool(ratio > stats.chi2.ppf(1.0 - 2.0 * LEVEL, 1))


def _run(recording: Recording, supply_v: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Stamps, angles (rad), volts and modes of a recording."""
    time_s = recording.time_s
    battery = recording.columns.get("battery_v", np.full(time_s.size, np.nan))
    known = ~np.isnan(battery)
    open_v = float(np.median(battery[known])) if known.any() else supply_v
    return (
        np.array(time_s),
        np.deg2rad(recording.columns["a_tacho_deg"]),
        recording.columns["a_power_pct"] / 100.0 * open_v,
        np.array(recording.columns.get("a_mode", np.zeros(time_s.size))),
    )


@compiled
def _surprise(
    logs: FloatArray, time_s: FloatArray, angle: FloatArray, volts: FloatArray, mode: FloatArray
) -> float:
    """Minus the logarithm of the likelihood of one recording; coasting rows are bridged by a wide guess."""
    gain, damping, dry, noise, drift = np.exp(logs)
    theta, omega = angle[0], 0.0
    p00, p01, p11 = noise**2, 0.0, 1.0
    total = 0.0
    for row in range(1, time_s.size):
        span = time_s[row] - time_s[row - 1]
        steps = max(1, math.ceil(span / 0.005))
        h = span / steps
        push = gain * volts[row - 1] if mode[row - 1] == 0.0 else 0.0
        wide = 0.0 if mode[row - 1] == 0.0 else 100.0
        for _ in range(steps):
            way = math.tanh(omega / SLOW_RAD_S)
            slope = -damping - dry * (1.0 - way * way) / SLOW_RAD_S
            after = 1.0 / (1.0 - h * slope)
            omega += h * (push - damping * omega - dry * way) * after
            theta += h * omega
            p11 = after * after * (p11 + h * (drift**2 + wide))
            p01 = after * p01 + h * p11
            p00 += 2.0 * h * p01 + h * h * p11
        spread = p00 + noise**2
        miss = angle[row] - theta
        total += 0.5 * (math.log(2.0 * math.pi * spread) + miss * miss / spread)
        k0, k1 = p00 / spread, p01 / spread
        theta += k0 * miss
        omega += k1 * miss
        p11 -= k1 * p01
        p01 -= k0 * p01
        p00 -= k0 * p00
    return float(total)
