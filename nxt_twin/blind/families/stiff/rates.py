"""The equations of motion of this family."""

from __future__ import annotations

import math

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import compiled
from nxt_twin.blind.families.numbers import Numbers

THETA, OMEGA, CURRENT, FINE, COARSE, THETA_L, OMEGA_L, HEAT, MISCOUNT, MEMORY = range(10)
STATES = 10
FLOAT, COAST, BRAKE = 1, 2, 3
AGEING_FRICTION, EDDY_BRAKE, TIRED_MAGNET, CRANK = 1, 2, 3, 4

REACH_RAD = 6e-4
FINE_SHARE, FINE_REACH, COARSE_REACH = 0.6, 0.8, 1.6
OPEN_S = 3e-4
BRUSH_A = 0.006
CONTACT_HZ, CONTACT_DAMPING, CONTACT_ROUNDING = 90.0, 0.3, 2e-4


@compiled
def volts(m: Numbers, t: float, current: float, duty: float, mode: int) -> float:
    """The battery's voltage under load, V."""
    drawn = abs(current) if mode == FLOAT else current * duty
    if mode >= COAST:
        drawn = 0.0
    return m.supply_v - m.drain_v_per_s * t - m.internal_resistance_ohm * drawn


@compiled
def _current_rate(m: Numbers, t: float, x: FloatArray, duty: float, mode: int, constant: float) -> float:
    current = x[CURRENT]
    if mode == COAST:
        return float(-current / OPEN_S)
    ohm = m.resistance_ohm * (1.0 + x[HEAT])
    given = math.copysign(abs(duty) ** m.power_exponent, duty)
    supply = volts(m, t, current, given, mode)
    emf = constant * x[OMEGA]
    if mode == FLOAT:
        way = math.copysign(1.0, given)
        flows = abs(given) * max(0.0, supply - way * emf - m.drop_v) / ohm
        if m.current_limit_a > 0.0:
            flows = min(flows, m.current_limit_a)
        return float((way * flows - current) / OPEN_S)
    pushed = (
        (given * supply if mode == 0 else 0.0) - emf - ohm * current - m.drop_v * math.tanh(current / BRUSH_A)
    )
    if m.current_limit_a > 0.0 and pushed * current > 0.0:
        pushed *= 0.5 * (1.0 - math.tanh((abs(current) / m.current_limit_a - 1.0) / 0.01))
    return float(pushed / m.inductance_h)


@compiled
def _level(m: Numbers, t: float, x: FloatArray, carried: float) -> float:
    """Height of dry friction in steady sliding, N·m."""
    omega = x[OMEGA]
    lean = math.tanh(omega / 0.01)
    level = 0.5 * (1.0 + lean) * m.coulomb_forward_nm + 0.5 * (1.0 - lean) * m.coulomb_reverse_nm
    if m.stiction_excess_nm != 0.0:
        pace = (omega * omega + 1e-6) / m.stribeck_speed_rad_s**2
        level += m.stiction_excess_nm * math.exp(-(pace**0.65))
    if m.cold_extra_torque_nm != 0.0:
        level += m.cold_extra_torque_nm * math.exp(-max(t, 0.0) / m.warmup_time_s)
    if m.binding_torque_nm != 0.0:
        away = math.sin(0.5 * (m.binding_cycles * x[THETA] + m.binding_phase_rad))
        level += m.binding_torque_nm * (7.0 / (1.0 + 6.0 * away * away) - 1.0) / 6.0
    if m.stranger == AGEING_FRICTION:
        level += m.a * math.log1p(max(0.0, x[MEMORY]) / 0.02)
    return level + m.friction_per_torque * carried


@compiled
def bristles(m: Numbers, t: float, x: FloatArray, carried: float, out: FloatArray) -> float:
    """Friction of both sets (N·m) on the hub; `out` gets how fast they bend."""
    reach = m.presliding_rad if m.presliding_rad > 0.0 else REACH_RAD
    plain = 0.5 * (m.coulomb_forward_nm + m.coulomb_reverse_nm)
    out[FINE] = out[COARSE] = 0.0
    level = _level(m, t, x, carried)
    if plain <= 0.0 and level <= 1e-9:
        return 0.0
    stiff = max(plain, 1e-4) / reach
    omega = x[OMEGA]
    share = level / stiff
    out[FINE] = omega - abs(omega) * x[FINE] / max(share * FINE_REACH, 1e-9)
    out[COARSE] = omega - abs(omega) * x[COARSE] / max(share * COARSE_REACH, 1e-9)
    weight_fine, weight_coarse = FINE_SHARE / FINE_REACH, (1.0 - FINE_SHARE) / COARSE_REACH
    bent = stiff * (weight_fine * x[FINE] + weight_coarse * x[COARSE])
    damping = 0.9 * math.sqrt(stiff * m.inertia_kg_m2) / (1.0 + (omega / 0.1) ** 2)
    return float(bent + damping * (weight_fine * out[FINE] + weight_coarse * out[COARSE]))


@compiled
def _hanging(m: Numbers, t: float, x: FloatArray) -> float:
    theta = x[THETA]
    torque = m.load_torque_nm - m.spring_nm_per_rad * (theta - m.spring_rest_rad)
    if m.gravity_torque_nm != 0.0 and t >= m.gravity_from_s:
        torque -= m.gravity_torque_nm * math.sin(theta + m.gravity_phase_rad)
    if m.cogging_torque_nm != 0.0:
        turn = m.cogging_cycles * theta + m.cogging_phase_rad
        torque += m.cogging_torque_nm * (math.sin(turn) + 0.08 * math.sin(2.0 * turn))
    if m.stranger == EDDY_BRAKE:
        torque -= m.a * 2.0 * x[OMEGA] * m.b / (x[OMEGA] ** 2 + m.b**2)
    return float(torque)


@compiled
def _coupled(m: Numbers, twist: float, rate: float) -> float:
    if m.gap_rad == 0.0:
        return m.shaft_stiffness_nm_per_rad * twist + m.shaft_damping_nm_s_per_rad * rate
    side = math.copysign(1.0, twist)
    depth = (side * twist - 0.5 * m.gap_rad) / CONTACT_ROUNDING
    if depth < -30.0:
        return 0.0
    pressed = CONTACT_ROUNDING * (math.log1p(math.exp(depth)) if depth < 30.0 else depth)
    closed = 1.0 / (1.0 + math.exp(-min(max(depth, -30.0), 30.0)))
    joint = m.inertia_kg_m2 * m.load_inertia_kg_m2 / (m.inertia_kg_m2 + m.load_inertia_kg_m2)
    pulsation = 2.0 * math.pi * CONTACT_HZ
    return float(
        side * joint * pulsation * (pulsation * pressed + 2.0 * CONTACT_DAMPING * closed * side * rate)
    )


@compiled
def push(m: Numbers, t: float, x: FloatArray, out: FloatArray) -> float:
    """All torque on the hub (N·m); `out` gets the rates of the bristles and of the second inertia."""
    constant = m.torque_constant_nm_per_a
    if m.stranger == TIRED_MAGNET:
        constant *= 1.0 - m.a * x[MEMORY]
    drive = constant * x[CURRENT]
    torque = drive + _hanging(m, t, x)
    torque -= (m.viscous_friction_nm_s_per_rad + m.quadratic_drag_nm_s2_per_rad2 * abs(x[OMEGA])) * x[OMEGA]
    held = bristles(m, t, x, abs(drive), out)
    borne = 0.0
    out[THETA_L] = out[OMEGA_L] = 0.0
    if m.load_inertia_kg_m2 != 0.0:
        pull = _coupled(m, x[THETA] - x[THETA_L], x[OMEGA] - x[OMEGA_L])
        borne = m.share * held
        rubbed = m.share * m.coulomb_forward_nm * math.tanh(x[OMEGA_L] / 0.02)
        out[THETA_L] = x[OMEGA_L]
        out[OMEGA_L] = (pull - rubbed) / m.load_inertia_kg_m2
        torque -= pull
    return float(torque - (held - borne))


@compiled
def rates(
    m: Numbers, t: float, x: FloatArray, duty: float, mode: int, held: bool, heavier: bool
) -> FloatArray:
    """How the state changes; `held` against a stop, `heavier` once a payload is on."""
    out = np.zeros(STATES)
    torque = push(m, t, x, out)
    inertia = m.inertia_kg_m2 + (m.added_inertia_kg_m2 if heavier else 0.0)
    if m.stranger == CRANK:
        turn = m.b * x[THETA] + m.d
        torque += 0.5 * m.a * m.inertia_kg_m2 * m.b * math.sin(turn) * x[OMEGA] ** 2
        inertia *= 1.0 + m.a * math.cos(turn)
    constant = m.torque_constant_nm_per_a
    if m.stranger == TIRED_MAGNET:
        constant *= 1.0 - m.a * x[MEMORY]
        out[MEMORY] = (min(1.0, abs(x[OMEGA]) / m.c) - x[MEMORY]) / m.b
    if m.stranger == AGEING_FRICTION:
        out[MEMORY] = 1.0 - abs(x[OMEGA]) * x[MEMORY] / m.b
    out[CURRENT] = _current_rate(m, t, x, duty, mode, constant)
    out[HEAT] = m.resistance_rise_per_joule * m.resistance_ohm * x[CURRENT] ** 2 - x[HEAT] / m.thermal_time_s
    if m.lost_fraction != 0.0:
        fast = 0.5 + 0.5 * math.tanh((abs(x[OMEGA]) - m.lost_above_rad_s) / 0.05)
        out[MISCOUNT] = -m.lost_fraction * fast * x[OMEGA]
    if not held:
        out[THETA], out[OMEGA] = x[OMEGA], torque / inertia
    return out


@compiled
def slopes(
    m: Numbers, t: float, x: FloatArray, duty: float, mode: int, held: bool, heavier: bool
) -> FloatArray:
    """How the rates change with the state, by differences, shape (10, 10)."""
    here = rates(m, t, x, duty, mode, held, heavier)
    out = np.zeros((STATES, STATES))
    beside = x.copy()
    for column in range(STATES):
        nudge = 1e-7 * max(abs(x[column]), 1e-2)
        beside[column] = x[column] + nudge
        out[:, column] = (rates(m, t, beside, duty, mode, held, heavier) - here) / nudge
        beside[column] = x[column]
    return out
