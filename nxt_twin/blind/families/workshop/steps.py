"""Steps through time: explicit in speed, implicit in current, exact in sticking."""

from __future__ import annotations

import math

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import compiled
from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.families.workshop import torques, winding
from nxt_twin.blind.families.workshop.base import Flaws
from nxt_twin.machine_code import forget_outdated

LONGEST_STEP_S = 40e-6
STILL_RAD_S = 1e-3
THETA, OMEGA, CURRENT, THETA_L, OMEGA_L, HEAT, OIL, DIP, MISCOUNT, MEMORY, ANCHOR = range(11)
STATES = 11


@compiled
def _rubbed(omega: float, push: float, level: float, holding: float, inertia: float, h: float) -> float:
    """The speed after a step under a torque `push` and dry friction; within a dead band of speed it sticks."""
    if abs(omega) < STILL_RAD_S:
        if abs(push) <= holding:
            return 0.0
        return float(omega + h * (push - math.copysign(level, push)) / inertia)
    after = float(omega + h * (push - math.copysign(level, omega)) / inertia)
    return 0.0 if after * float(omega) < 0.0 else after


@compiled
def _bent(m: Numbers, x: FloatArray, level: float) -> float:
    """Torque (N·m) of friction that is elastic before it slides: a spring whose foot is dragged along."""
    stiffness = 0.5 * (m.coulomb_forward_nm + m.coulomb_reverse_nm) / m.presliding_rad
    reach = level / stiffness
    x[ANCHOR] = min(max(x[ANCHOR], x[THETA] - reach), x[THETA] + reach)
    damping = 0.25 * math.sqrt(stiffness * m.inertia_kg_m2)
    sliding = abs(x[THETA] - x[ANCHOR]) >= reach * 0.999
    held = 0.0 if sliding else damping * x[OMEGA]
    return float(-stiffness * (x[THETA] - x[ANCHOR]) - held)


@compiled
def _supply(m: Numbers, f: Flaws, t: float, h: float, x: FloatArray, duty: float, mode: int) -> float:
    """The duty that the bridge gives; winding, battery and their slow states go on by one step."""
    given = math.copysign(abs(duty) ** m.power_exponent, duty)
    if m.stranger == torques.BROWNOUT:
        if abs(x[CURRENT]) > m.a and t > x[MEMORY]:
            x[MEMORY] = t + m.b
        if t < x[MEMORY]:
            given = 0.0
    drawn = winding.drawn_a(x[CURRENT], given, mode)
    supply = winding.volts(m, t, drawn, x[DIP])
    ohm = winding.resistance(m, x[THETA], x[HEAT])
    emf = m.torque_constant_nm_per_a * x[OMEGA]
    x[DIP] += h / f.recovery_s * (f.tired_ohm * drawn - x[DIP])
    x[HEAT] += h * (
        m.resistance_rise_per_joule * m.resistance_ohm * x[CURRENT] ** 2 - x[HEAT] / m.thermal_time_s
    )
    x[CURRENT] = winding.next_current(m, h, x[CURRENT], ohm, emf, supply, given, mode)
    return given


@compiled
def _drive(m: Numbers, f: Flaws, x: FloatArray) -> float:
    """The motor's torque, N·m."""
    ripple = 1.0 + f.ripple * math.sin(f.ripple_cycles * x[THETA])
    fade = 1.0 - f.fade_per_a * abs(x[CURRENT])
    return float(m.torque_constant_nm_per_a * x[CURRENT] * ripple * fade)


@compiled
def _held(m: Numbers, h: float, level: float, x: FloatArray) -> float:
    """What friction holds at rest (N·m); it may grow with the time at rest."""
    if m.stranger != torques.DWELL_ADHESION:
        return level
    x[MEMORY] = x[MEMORY] + h if x[OMEGA] == 0.0 else max(0.0, x[MEMORY] - 20.0 * h * abs(x[OMEGA]))
    return level + m.a * (1.0 - math.exp(-x[MEMORY] / m.b))


@compiled
def _step(m: Numbers, f: Flaws, t: float, h: float, x: FloatArray, duty: float, mode: int) -> None:
    _supply(m, f, t, h, x, duty, mode)
    drive = _drive(m, f, x)
    push = drive + torques.hanging(m, f, t, x[THETA], x[OMEGA])
    push -= (m.viscous_friction_nm_s_per_rad + m.quadratic_drag_nm_s2_per_rad2 * abs(x[OMEGA])) * x[OMEGA]
    inertia = m.inertia_kg_m2 + (m.added_inertia_kg_m2 if t >= m.added_from_s else 0.0)
    aim = x[OMEGA] if abs(x[OMEGA]) >= STILL_RAD_S else push
    level = torques.sliding(m, f, t, x[THETA], aim, abs(drive), x[OIL])
    borne = 0.0
    if m.load_inertia_kg_m2 != 0.0:
        pull = torques.coupling(m, x[THETA] - x[THETA_L], x[OMEGA] - x[OMEGA_L])
        push -= pull
        borne = m.share * level
        x[OMEGA_L] = _rubbed(x[OMEGA_L], pull, borne, borne, m.load_inertia_kg_m2, h)
        x[THETA_L] += h * x[OMEGA_L]
    level -= borne
    x[OIL] += h / f.thaw_time_s * (min(1.0, abs(x[OMEGA]) / 5.0) - x[OIL])
    if m.presliding_rad > 0.0:
        x[OMEGA] += h * (push + _bent(m, x, level)) / inertia
    else:
        breakaway = _held(m, h, level, x)
        x[OMEGA] = _rubbed(x[OMEGA], push, level, breakaway, inertia, h)
    x[THETA] += h * x[OMEGA]
    if m.lost_fraction != 0.0 and abs(x[OMEGA]) > m.lost_above_rad_s:
        x[MISCOUNT] -= h * m.lost_fraction * x[OMEGA]


@compiled
def advance(
    m: Numbers, f: Flaws, from_s: float, stops_s: FloatArray, duty: float, mode: int, x: FloatArray
) -> FloatArray:
    """Step from `from_s` through `stops_s` under one command; `x` goes along.

    Returns:
        Hub angle (rad), miscount (rad), battery (V) at each stop.
    """
    out = np.zeros((stops_s.size, 3))
    now = from_s
    for stop in range(stops_s.size):
        span = stops_s[stop] - now
        steps = max(0, math.ceil(span / LONGEST_STEP_S - 1e-6))
        for step in range(steps):
            _step(m, f, now + step * span / steps, span / steps, x, duty, mode)
        now = stops_s[stop]
        out[stop, 0], out[stop, 1] = x[THETA], x[MISCOUNT]
        out[stop, 2] = winding.volts(m, now, winding.drawn_a(x[CURRENT], duty, mode), x[DIP])
    return out


forget_outdated(advance, torques, winding)
