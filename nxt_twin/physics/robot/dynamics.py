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
STICK_RAD_PER_S: Final = 0.08
_STILL_M_PER_S: Final = 4e-3
LEAST_BACK_M: Final = 5e-3
STILL_RAD_PER_S: Final = 0.1
DROPS_V: Final = 0.05
"""Where the voltage across a winding comes so near to its drop, current sets in."""


@njit(cache=True, error_model="numpy")
def smooth_sign(x: float) -> float:
    """A sign that goes smoothly through zero within about one."""
    return x / math.sqrt(1.0 + x * x)


@njit(cache=True, error_model="numpy")
def dropped(across: float, drop: float) -> float:
    """The voltage that brushes take: the whole drop, or all that there is where that is less; so smoothly."""
    above, below = across + drop, across - drop
    soft = DROPS_V * DROPS_V
    return 0.5 * (math.sqrt(above * above + soft) - math.sqrt(below * below + soft))


@njit(cache=True, error_model="numpy")
def driving(volts: float, open_v: float, floats: float) -> tuple[float, float]:
    """The voltage that drives a winding, and for which share of the time.

    Where the off phase is open, the whole voltage does, for the duty's share; else its mean does, all the time.
    """
    if math.isnan(volts):
        return 0.0, 0.0
    if floats > 0.5:
        return math.copysign(open_v, volts), abs(volts) / open_v
    return volts, 1.0


@njit(cache=True, error_model="numpy")
def _force(
    rate: float, bridge: tuple[float, float], floats: float, p: FloatArray, k: int, radius: float
) -> float:
    """What wheel k would push with if its rotor had no inertia, N; where the off phase is open, no current brakes."""
    across = bridge[0] - p[k] * rate
    torque = bridge[1] * p[k] * (across - dropped(across, p[24 + k])) / p[2 + k]
    if floats > 0.5 and across * bridge[0] <= 0.0:
        torque = 0.0
    way = smooth_sign(rate / STICK_RAD_PER_S)
    friction = (p[4 + k] + p[20 + k] * way) * way + (p[6 + k] + p[22 + k] * abs(rate)) * rate
    return float((torque - friction) / radius)


@njit(cache=True, error_model="numpy")
def share_left(
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
        source, share = driving(volts[k], open_v, floats[k])
        if share > 0.0:
            duty = share * source / open_v
            drawn_a += duty * (source - p[k] * rates[k]) / p[2 + k]
            grows_per_ohm += duty * source / open_v / p[2 + k]
    return float(1.0 - p[19] * max(drawn_a, 0.0) / (open_v * (1.0 + p[19] * grows_per_ohm)))


@njit(cache=True, error_model="numpy")
def gravity(way: tuple[float, float], p: FloatArray) -> tuple[float, float]:
    """Gravity's force along the robot and to its left on a floor that rises, N.

    Args:
        way: cosine and sine of the robot's heading.
        p: values in the order of `NAMES`.
    """
    weight = (p[10] + p[17]) * GRAVITY
    return -weight * (p[13] * way[0] + p[14] * way[1]), -weight * (p[14] * way[0] - p[13] * way[1])


@njit(cache=True, error_model="numpy")
def crawl(v: float, w: float, shape: FloatArray) -> float:
    """The caster's speed, with one added at which dry friction goes smoothly through zero, m/s."""
    across = shape[3] * w
    return math.sqrt(_STILL_M_PER_S * _STILL_M_PER_S + v * v + across * across)


@njit(cache=True, error_model="numpy")
def drag_per_speed(v: float, w: float, p: FloatArray, shape: FloatArray) -> float:
    """The caster's dry friction over its speed, N·s/m."""
    return float((p[12] + shape[5] * p[17] / p[10]) / crawl(v, w, shape))


@njit(cache=True, error_model="numpy")
def caster_share(p: FloatArray, shape: FloatArray) -> float:
    """By which share of itself the caster's drag grows for each m/s² of speeding up, which loads it."""
    return float(shape[4] / (GRAVITY * max(-p[16], LEAST_BACK_M)))


@njit(cache=True, error_model="numpy")
def inertias(v: float, w: float, p: FloatArray, shape: FloatArray) -> tuple[float, float, float, float]:
    """What travel and turn feel of both accelerations: kg, kg·m; kg·m, kg·m²."""
    half, mass, aside, ahead = 0.5 * shape[2], p[10] + p[17], p[15], p[16]
    left, right = p[8] / (shape[0] * shape[0]), p[9] / (shape[1] * shape[1])
    loads = caster_share(p, shape) * drag_per_speed(v, w, p, shape)
    yaw = p[11] * (1.0 + LOAD_GYRATION * p[17] / p[10]) + mass * (ahead * ahead + aside * aside)
    mixed = half * (right - left) - mass * aside
    return (
        mass + left + right + loads * v,
        mixed,
        mixed + loads * shape[3] * shape[3] * w,
        yaw + half * half * (left + right),
    )


@njit(cache=True, error_model="numpy")
def solved(m: tuple[float, float, float, float], along: float, about: float) -> tuple[float, float]:
    """The accelerations that a force along and a torque about give."""
    whole = m[0] * m[3] - m[1] * m[2]
    return (m[3] * along - m[1] * about) / whole, (m[0] * about - m[2] * along) / whole


@njit(cache=True, error_model="numpy")
def accelerations(
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
    held = share_left(rates, volts, floats, open_v, p)
    left, right = driving(volts[0], open_v, floats[0]), driving(volts[1], open_v, floats[1])
    left_n = _force(rates[0], (held * left[0], left[1]), floats[0], p, 0, shape[0])
    right_n = _force(rates[1], (held * right[0], right[1]), floats[1], p, 1, shape[1])
    mass, aside, ahead = p[10] + p[17], p[15], p[16]
    drag, high = drag_per_speed(v, w, p, shape), caster_share(p, shape)
    swing = ahead * w * w
    along = left_n + right_n + down[0] - drag * v + mass * swing + high * drag * v * swing
    about = half * (right_n - left_n) + ahead * down[1] - aside * down[0]
    about -= mass * ahead * v * w + p[18] * mass / p[10] * smooth_sign(w / STILL_RAD_PER_S)
    about += drag * back * back * w * (high * swing - 1.0)
    return solved(inertias(v, w, p, shape), along, about)


@njit(cache=True, error_model="numpy")
def longest_step_s(p: FloatArray) -> float:
    """A step in which dry friction turns no wheel back, not even a rotor alone."""
    longest = _STEP_S
    for k in range(2):
        most = p[4 + k] + abs(p[20 + k])
        longest = min(longest, p[8 + k] * STICK_RAD_PER_S / max(most, 1e-12))
    return max(longest, _SHORTEST_STEP_S)


@njit(cache=True, error_model="numpy")
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
    step_s = longest_step_s(p)
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
        for step in range(steps):
            way = (step + 0.5) / steps
            heading = heading_rad[row] + way * (heading_rad[row + 1] - heading_rad[row])
            down = gravity((math.cos(heading), math.sin(heading)), p)
            dv, dw = accelerations(v, w, down, both, open_off, open_v[row], p, shape)
            ev, ew = accelerations(v + h * dv, w + h * dw, down, both, open_off, open_v[row], p, shape)
            travel += h * (v + 0.5 * h * dv)
            turn += h * (w + 0.5 * h * dw)
            v += 0.5 * h * (dv + ev)
            w += 0.5 * h * (dw + ew)
    return found
