"""How powers turn a robot's wheels: two motors coupled by a body that rolls on them."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import njit

from nxt_twin.arrays import BoolArray, FloatArray

NAMES: Final = (
    "left_back_emf", "right_back_emf", "left_resistance", "right_resistance", "left_coulomb", "right_coulomb",
    "left_viscous", "right_viscous", "left_rotor", "right_rotor", "mass", "yaw_inertia",
    "drag_force", "slope_ahead", "slope_aside", "offset_left", "offset_forward", "added_mass",
)  # fmt: skip
"""What `wheel_angles` reads, SI; slopes are the floor's rise along the frame in which headings are measured."""

GRAVITY: Final = 9.81
LOAD_GYRATION: Final = 0.15
"""Square of a payload's radius of gyration by the robot's own; of a second brick or a box of cells it is 0.1 to 0.3."""
_STEP_S: Final = 1e-2
_STICK_RAD_PER_S: Final = 0.08
_STILL_M_PER_S: Final = 4e-3


@njit(cache=True)
def _sign(x: float) -> float:
    """A sign that goes smoothly through zero within about one."""
    return x / math.sqrt(1.0 + x * x)


@njit(cache=True)
def _force(rate: float, volts: float, p: FloatArray, k: int, radius: float) -> float:
    """What wheel k would push with if its rotor had no inertia, N; no current flows at no voltage (NaN)."""
    torque = 0.0 if math.isnan(volts) else p[k] * (volts - p[k] * rate) / p[2 + k]
    return float((torque - p[4 + k] * _sign(rate / _STICK_RAD_PER_S) - p[6 + k] * rate) / radius)


@njit(cache=True)
def _accelerations(
    v: float,
    w: float,
    down: tuple[float, float],
    volts: tuple[float, float],
    p: FloatArray,
    shape: FloatArray,
) -> tuple[float, float]:
    """Of travel and turn, for wheels that roll: Newton's and Euler's equations about the axle's middle.

    Args:
        v: travel.
        w: turning rate.
        down: gravity's force along the robot and to its left.
        volts: at the left and the right motor.
        p: values in the order of `NAMES`.
        shape: as `wheel_angles` takes it.
    """
    half, back = 0.5 * shape[2], shape[3]
    left_n = _force((v - half * w) / shape[0], volts[0], p, 0, shape[0])
    right_n = _force((v + half * w) / shape[1], volts[1], p, 1, shape[1])
    left_rotor, right_rotor = p[8] / (shape[0] * shape[0]), p[9] / (shape[1] * shape[1])
    mass, left, ahead = p[10] + p[17], p[15], p[16]
    speed = math.sqrt(v * v + back * back * w * w)
    drag = p[12] * _sign(speed / _STILL_M_PER_S) / max(speed, 1e-9)
    along = left_n + right_n + down[0] - drag * v + mass * ahead * w * w
    about = half * (right_n - left_n) + ahead * down[1] - left * down[0]
    about -= drag * back * back * w + mass * ahead * v * w
    inertia = (
        p[11] * (1.0 + LOAD_GYRATION * p[17] / p[10])
        + mass * (ahead * ahead + left * left)
        + half * half * (left_rotor + right_rotor)
    )
    heavy = mass + left_rotor + right_rotor
    mixed = half * (right_rotor - left_rotor) - mass * left
    whole = heavy * inertia - mixed * mixed
    return (inertia * along - mixed * about) / whole, (heavy * about - mixed * along) / whole


@njit(cache=True)
def wheel_angles(
    p: FloatArray,
    shape: FloatArray,
    time_s: FloatArray,
    volts: FloatArray,
    heading_rad: FloatArray,
    begins: BoolArray,
    start: FloatArray,
) -> FloatArray:
    """Angles of both wheels along a run, in windows that begin anew.

    Args:
        p: values in the order of `NAMES`.
        shape: radius of the left and of the right wheel, track, and the caster's distance behind the axle, m.
        time_s: stamps, shape (rows,).
        volts: mean voltage at both motors from each row to the next, shape (rows, 2); NaN where a motor is let go.
        heading_rad: as measured, shape (rows,).
        begins: rows at which the speeds are set anew.
        start: travel and turning rate there, shape (rows, 2).

    Returns:
        Shape (rows, 2), rad; zero at each row that begins.
    """
    found = np.zeros((time_s.size, 2))
    v, w, travel, turn = 0.0, 0.0, 0.0, 0.0
    for row in range(time_s.size):
        if begins[row]:
            v, w, travel, turn = start[row, 0], start[row, 1], 0.0, 0.0
        found[row, 0] = (travel - 0.5 * shape[2] * turn) / shape[0]
        found[row, 1] = (travel + 0.5 * shape[2] * turn) / shape[1]
        if row + 1 == time_s.size:
            break
        span = time_s[row + 1] - time_s[row]
        steps = max(1, math.ceil(span / _STEP_S))
        h = span / steps
        both = (volts[row, 0], volts[row, 1])
        weight = (p[10] + p[17]) * GRAVITY
        for step in range(steps):
            way = (step + 0.5) / steps
            heading = heading_rad[row] + way * (heading_rad[row + 1] - heading_rad[row])
            cosine, sine = math.cos(heading), math.sin(heading)
            down = (-weight * (p[13] * cosine + p[14] * sine), -weight * (p[14] * cosine - p[13] * sine))
            dv, dw = _accelerations(v, w, down, both, p, shape)
            ev, ew = _accelerations(v + h * dv, w + h * dw, down, both, p, shape)
            travel += h * (v + 0.5 * h * dv)
            turn += h * (w + 0.5 * h * dw)
            v += 0.5 * h * (dv + ev)
            w += 0.5 * h * (dw + ew)
    return found
