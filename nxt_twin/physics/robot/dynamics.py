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
    "scrub_torque", "battery_resistance", "left_uneven", "right_uneven", "left_drag", "right_drag",
    "left_drop", "right_drop",
)  # fmt: skip
"""What `wheel_angles` reads, SI; slopes are the floor's rise along the frame in which headings are measured.

Scrub is the torque of both tyres against turning. A motor's friction is its Coulomb friction plus `uneven` forward, and
minus it in reverse; its drag grows with the square of the speed; its drop is a voltage against the current.
"""

GRAVITY: Final = 9.81
LOAD_GYRATION: Final = 0.15
"""Square of a payload's radius of gyration by the robot's own; of a second brick or a box of cells it is 0.1 to 0.3."""
_STEP_S: Final = 1e-2
_SHORTEST_STEP_S: Final = 2e-3
_STICK_RAD_PER_S: Final = 0.08
_STILL_M_PER_S: Final = 4e-3
_LEAST_BACK_M: Final = 5e-3
_STILL_RAD_PER_S: Final = 0.1
_DROPS_V: Final = 0.15
"""A voltage drop acts whole where the voltage across the winding is several times as large."""


@njit(cache=True)
def _sign(x: float) -> float:
    """A sign that goes smoothly through zero within about one."""
    return x / math.sqrt(1.0 + x * x)


@njit(cache=True)
def _bridge(volts: float, open_v: float, floats: float) -> tuple[float, float]:
    """The voltage that drives a winding, and for which share of the time.

    Where the off phase is open, the whole voltage does, for the duty's share; else its mean does, all the time.
    """
    if math.isnan(volts):
        return 0.0, 0.0
    if floats > 0.5:
        return math.copysign(open_v, volts), abs(volts) / open_v
    return volts, 1.0


@njit(cache=True)
def _force(
    rate: float, bridge: tuple[float, float], floats: float, p: FloatArray, k: int, radius: float
) -> float:
    """What wheel k would push with if its rotor had no inertia, N; where the off phase is open, no current brakes."""
    across = bridge[0] - p[k] * rate
    torque = bridge[1] * p[k] * (across - p[24 + k] * math.tanh(across / _DROPS_V)) / p[2 + k]
    if floats > 0.5 and across * bridge[0] <= 0.0:
        torque = 0.0
    way = _sign(rate / _STICK_RAD_PER_S)
    friction = (p[4 + k] + p[20 + k] * way) * way + (p[6 + k] + p[22 + k] * abs(rate)) * rate
    return float((torque - friction) / radius)


@njit(cache=True)
def _share_left(
    rates: tuple[float, float],
    volts: tuple[float, float],
    floats: tuple[float, float],
    open_v: float,
    p: FloatArray,
) -> float:
    """The share of the open-circuit voltage that the battery holds while it feeds both motors.

    A bridge draws its motor's current for the share of the time in which it is on.
    """
    if p[19] == 0.0:
        return 1.0
    drawn_a, grows_per_ohm = 0.0, 0.0
    for k in range(2):
        source, share = _bridge(volts[k], open_v, floats[k])
        if share > 0.0:
            duty = share * source / open_v
            drawn_a += duty * (source - p[k] * rates[k]) / p[2 + k]
            grows_per_ohm += duty * source / open_v / p[2 + k]
    return float(1.0 - p[19] * max(drawn_a, 0.0) / (open_v * (1.0 + p[19] * grows_per_ohm)))


@njit(cache=True)
def _accelerations(
    v: float,
    w: float,
    down: tuple[float, float],
    volts: tuple[float, float],
    floats: tuple[float, float],
    open_v: float,
    p: FloatArray,
    shape: FloatArray,
) -> tuple[float, float]:
    """Of travel and turn, for wheels that roll: Newton's and Euler's equations about the axle's middle.

    Args:
        v: travel.
        w: turning rate.
        down: gravity's force along the robot and to its left.
        volts: at the left and the right motor, from a battery that does not sag.
        floats: 1 where a bridge is open in its off phase, 0 where it shorts the motor.
        open_v: the battery's open-circuit voltage.
        p: values in the order of `NAMES`.
        shape: as `wheel_angles` takes it.
    """
    half, back = 0.5 * shape[2], shape[3]
    rates = ((v - half * w) / shape[0], (v + half * w) / shape[1])
    held = _share_left(rates, volts, floats, open_v, p)
    left, right = _bridge(volts[0], open_v, floats[0]), _bridge(volts[1], open_v, floats[1])
    left_n = _force(rates[0], (held * left[0], left[1]), floats[0], p, 0, shape[0])
    right_n = _force(rates[1], (held * right[0], right[1]), floats[1], p, 1, shape[1])
    left_rotor, right_rotor = p[8] / (shape[0] * shape[0]), p[9] / (shape[1] * shape[1])
    mass, aside, ahead = p[10] + p[17], p[15], p[16]
    speed = math.sqrt(v * v + back * back * w * w)
    drag = (p[12] + shape[5] * p[17] / p[10]) * _sign(speed / _STILL_M_PER_S) / max(speed, 1e-9)
    along = left_n + right_n + down[0] - drag * v + mass * ahead * w * w
    about = half * (right_n - left_n) + ahead * down[1] - aside * down[0]
    about -= (
        drag * back * back * w + mass * ahead * v * w + p[18] * mass / p[10] * _sign(w / _STILL_RAD_PER_S)
    )
    inertia = (
        p[11] * (1.0 + LOAD_GYRATION * p[17] / p[10])
        + mass * (ahead * ahead + aside * aside)
        + half * half * (left_rotor + right_rotor)
    )
    heavy = mass + left_rotor + right_rotor
    mixed = half * (right_rotor - left_rotor) - mass * aside
    # Speeding up loads the caster, whose drag then grows.
    high = shape[4] / (GRAVITY * max(-ahead, _LEAST_BACK_M))
    pulls, turns = high * drag * v, high * drag * back * back * w
    along, about = along + pulls * ahead * w * w, about + turns * ahead * w * w
    whole = (heavy + pulls) * inertia - mixed * (mixed + turns)
    return (inertia * along - mixed * about) / whole, (
        (heavy + pulls) * about - (mixed + turns) * along
    ) / whole


@njit(cache=True)
def _step_s(p: FloatArray) -> float:
    """A step in which neither dry friction nor a voltage drop turns a wheel back, not even a rotor alone."""
    longest = _STEP_S
    for k in range(2):
        most = p[4 + k] + abs(p[20 + k])
        longest = min(longest, p[8 + k] * _STICK_RAD_PER_S / max(most, 1e-12))
        kicks = p[k] * p[k] * abs(p[24 + k]) / (p[2 + k] * _DROPS_V)
        longest = min(longest, p[8 + k] / max(kicks, 1e-12))
    return max(longest, _SHORTEST_STEP_S)


@njit(cache=True)
def wheel_angles(
    p: FloatArray,
    shape: FloatArray,
    time_s: FloatArray,
    volts: FloatArray,
    heading_rad: FloatArray,
    begins: BoolArray,
    start: FloatArray,
    open_v: FloatArray,
    floats: FloatArray,
) -> FloatArray:
    """Angles of both wheels along a run, in windows that begin anew.

    Args:
        p: values in the order of `NAMES`.
        shape: radius of the left and of the right wheel, track, and the caster's distance behind the axle, m. Then the
            height of the centre of mass, m; 0 leaves the caster's load as it is. Then the caster's drag without a
            payload, N, which grows with one.
        time_s: stamps, shape (rows,).
        volts: mean voltage at both motors from each row to the next, shape (rows, 2); NaN where a motor is let go.
        heading_rad: as measured, shape (rows,).
        begins: rows at which the speeds are set anew.
        start: travel and turning rate there, shape (rows, 2).
        open_v: the battery's open-circuit voltage, shape (rows,).
        floats: 1 where a bridge is open in its off phase, 0 where it shorts its motor, shape (rows, 2).

    Returns:
        Shape (rows, 2), rad; zero at each row that begins.
    """
    found = np.zeros((time_s.size, 2))
    v, w, travel, turn = 0.0, 0.0, 0.0, 0.0
    step_s = _step_s(p)
    for row in range(time_s.size):
        if begins[row]:
            v, w, travel, turn = start[row, 0], start[row, 1], 0.0, 0.0
        found[row, 0] = (travel - 0.5 * shape[2] * turn) / shape[0]
        found[row, 1] = (travel + 0.5 * shape[2] * turn) / shape[1]
        if row + 1 == time_s.size:
            break
        span = time_s[row + 1] - time_s[row]
        steps = max(1, math.ceil(span / step_s))
        h = span / steps
        both, open_off = (volts[row, 0], volts[row, 1]), (floats[row, 0], floats[row, 1])
        weight = (p[10] + p[17]) * GRAVITY
        for step in range(steps):
            way = (step + 0.5) / steps
            heading = heading_rad[row] + way * (heading_rad[row + 1] - heading_rad[row])
            cosine, sine = math.cos(heading), math.sin(heading)
            down = (-weight * (p[13] * cosine + p[14] * sine), -weight * (p[14] * cosine - p[13] * sine))
            dv, dw = _accelerations(v, w, down, both, open_off, open_v[row], p, shape)
            ev, ew = _accelerations(v + h * dv, w + h * dw, down, both, open_off, open_v[row], p, shape)
            travel += h * (v + 0.5 * h * dv)
            turn += h * (w + 0.5 * h * dw)
            v += 0.5 * h * (dv + ev)
            w += 0.5 * h * (dw + ew)
    return found
