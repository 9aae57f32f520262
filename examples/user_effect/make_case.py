"""Record a motor with a centrifugal brake, as a case that `nxt-twin diagnose` reads.

The motor is a little simulation of its own: it shares no code with nxt-twin, so that finding the brake means something.
Usage: python make_case.py FOLDER
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

BASELINE = """\
plant:
  kind: dc_motor
  resistance_ohm: 7.6
  torque_constant_nm_per_a: 0.4908
  back_emf_v_s_per_rad: 0.4908
  coulomb_friction_nm: 8.45e-3
  viscous_friction_nm_s_per_rad: 1.92e-3
  inertia_kg_m2: 1.2e-3
  supply_v: 8.0
port: a
recordings: [r1.csv, r2.csv]
holdout: [r3.csv]
"""

BRAKE_NM_S2_PER_RAD2 = 9e-4
ENGAGE_SPEED_RAD_S = 7.0

SUPPLY_V = 8.0
STEP_S = 5e-4
POLL_S = 0.01
RUN_S = 12.0


def acceleration(speed: float, power: float) -> float:
    """Acceleration of the true motor, rad/s²: a little heavier and rougher than the baseline says."""
    current = (power * SUPPLY_V - 0.48 * speed) / 7.9
    torque = 0.48 * current - 0.010 * math.tanh(speed / 0.02) - 0.0021 * speed
    if abs(speed) > ENGAGE_SPEED_RAD_S:
        torque -= math.copysign(BRAKE_NM_S2_PER_RAD2 * (speed**2 - ENGAGE_SPEED_RAD_S**2), speed)
    return torque / 1.3e-3


def moved(angle: float, speed: float, rate: Callable[[float], float]) -> tuple[float, float]:
    """Angle and speed one step later, by Heun's rule."""
    first = rate(speed)
    second = rate(speed + STEP_S * first)
    after = speed + 0.5 * STEP_S * (first + second)
    return angle + 0.5 * STEP_S * (speed + after), after


def recording(seed: int) -> list[tuple[float, int, int]]:
    """Rows of time (s), power (%) and the encoder's whole degrees: random levels, each held for a while."""
    rng = np.random.default_rng(seed)
    rows = []
    angle, speed, power, change_s = float(rng.uniform(0.0, 0.01)), 0.0, 0, 0.3
    for poll in range(round(RUN_S / POLL_S)):
        now_s = poll * POLL_S
        if now_s >= change_s - 1e-9:
            power = int(rng.integers(-100, 101))
            change_s = now_s + float(rng.uniform(0.25, 0.8))
        rows.append((now_s, power, math.floor(math.degrees(angle))))
        for _ in range(round(POLL_S / STEP_S)):
            angle, speed = moved(angle, speed, lambda w, u=power / 100.0: acceleration(w, u))
    return rows


def write_case(folder: Path) -> None:
    """Write the case's three recordings and its baseline."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "case.yaml").write_text(BASELINE, encoding="utf-8")
    for number in (1, 2, 3):
        with (folder / f"r{number}.csv").open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(["time_s", "a_power_pct", "a_tacho_deg"])
            writer.writerows((f"{t:.4f}", power, count) for t, power, count in recording(number))


if __name__ == "__main__":
    write_case(Path(sys.argv[1]))
