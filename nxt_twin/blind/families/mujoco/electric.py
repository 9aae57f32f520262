"""All but the mechanics: winding, bridge, battery, the budget of friction, torques that no body makes."""

from __future__ import annotations

import math

from nxt_twin.arrays import FloatArray
from nxt_twin.blind.families.compiled import compiled
from nxt_twin.blind.families.numbers import Numbers

FLOAT, COAST = 1, 2
CURRENT, HEAT, MISCOUNT, VOLTS = range(4)
SLOTS = 4
OPEN_S = 2e-4
BRUSH_A = 0.003


@compiled
def current_after(
    m: Numbers, t: float, h: float, x: FloatArray, omega: float, duty: float, mode: int
) -> float:
    """The winding's mean current (A) after `h` seconds: the exact course towards where it tends; x's volts follow."""
    ohm = m.resistance_ohm * (1.0 + x[HEAT])
    open_v = m.supply_v - m.drain_v_per_s * t
    emf = m.torque_constant_nm_per_a * omega
    given = math.copysign(abs(duty) ** m.power_exponent, duty)
    held = m.drop_v * x[CURRENT] / (abs(x[CURRENT]) + BRUSH_A)
    lasting = m.inductance_h / ohm
    if mode >= COAST:
        tends = 0.0 if mode == COAST else (-emf - held) / ohm
        lasting = OPEN_S if mode == COAST else lasting
        x[VOLTS] = open_v
    elif mode == FLOAT:
        way = math.copysign(1.0, given)
        flows = max(0.0, open_v - way * emf - m.drop_v) / (ohm + m.internal_resistance_ohm)
        tends, lasting = given * flows, OPEN_S
        x[VOLTS] = open_v - m.internal_resistance_ohm * abs(tends)
    else:
        tends = (given * open_v - emf - held) / (ohm + m.internal_resistance_ohm * given * given)
        x[VOLTS] = open_v - m.internal_resistance_ohm * given * x[CURRENT]
    after = float(tends + (x[CURRENT] - tends) * math.exp(-h / lasting))
    if m.current_limit_a > 0.0:
        after = min(max(after, -m.current_limit_a), m.current_limit_a)
    return after


@compiled
def friction_loss(m: Numbers, t: float, theta: float, omega: float, carried: float, leaning: float) -> float:
    """The friction (N·m) that the hub's joint may take up, by direction of motion or, at rest, of the push."""
    ahead = omega > 1e-3 or (abs(omega) <= 1e-3 and leaning > 0.0)
    level = m.coulomb_forward_nm if ahead else m.coulomb_reverse_nm
    if m.stiction_excess_nm != 0.0:
        level += m.stiction_excess_nm * math.exp(-((omega / m.stribeck_speed_rad_s) ** 2))
    if m.cold_extra_torque_nm != 0.0:
        level += m.cold_extra_torque_nm * math.exp(-max(t, 0.0) / m.warmup_time_s)
    if m.binding_torque_nm != 0.0:
        near = 0.5 + 0.5 * math.cos(m.binding_cycles * theta + m.binding_phase_rad)
        level += m.binding_torque_nm * near * near
    return level + m.friction_per_torque * carried


@compiled
def govern(
    m: Numbers, t: float, h: float, qpos: FloatArray, qvel: FloatArray, x: FloatArray, duty: float, mode: int
) -> float:
    """One step of all this; the torque (N·m) on the hub that no body makes."""
    theta, omega = qpos[0], qvel[0]
    x[HEAT] += h * (
        m.resistance_rise_per_joule * m.resistance_ohm * x[CURRENT] ** 2 - x[HEAT] / m.thermal_time_s
    )
    x[CURRENT] = current_after(m, t, h, x, omega, duty, mode)
    if m.lost_fraction != 0.0 and abs(omega) > m.lost_above_rad_s:
        x[MISCOUNT] -= h * m.lost_fraction * omega
    torque = m.torque_constant_nm_per_a * x[CURRENT] + m.load_torque_nm
    torque -= m.quadratic_drag_nm_s2_per_rad2 * abs(omega) * omega
    if m.cogging_torque_nm != 0.0:
        torque += m.cogging_torque_nm * math.sin(m.cogging_cycles * theta + m.cogging_phase_rad)
    return float(torque)
