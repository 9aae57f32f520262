"""Torques on the hub: friction's height, what hangs on it, and what nobody's library holds."""

from __future__ import annotations

import math

from nxt_twin.blind.families.compiled import compiled
from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.families.workshop.base import Flaws

DWELL_ADHESION, BROWNOUT, CENTRIFUGAL_BRAKE, WORN_SEGMENT = 1, 2, 3, 4
STOP_HZ, STOP_DAMPING = 60.0, 0.35


@compiled
def sliding(m: Numbers, f: Flaws, t: float, theta: float, omega: float, carried: float, oil: float) -> float:
    """Height of dry friction (N·m) while sliding in the direction of `omega`."""
    forward = omega > 0.0
    level = (m.coulomb_forward_nm if forward else m.coulomb_reverse_nm) * (
        1.0 + (f.lean if forward else -f.lean)
    )
    level *= 1.0 - f.thaw * oil
    if m.stiction_excess_nm != 0.0:
        pace = omega / m.stribeck_speed_rad_s
        level += m.stiction_excess_nm / math.cosh(pace)
    if m.cold_extra_torque_nm != 0.0:
        level += m.cold_extra_torque_nm * math.exp(-max(t, 0.0) / m.warmup_time_s)
    if m.binding_torque_nm != 0.0:
        near = math.cos(0.5 * (m.binding_cycles * theta + m.binding_phase_rad))
        level += m.binding_torque_nm * near**4
    return level + (f.load + m.friction_per_torque) * carried


@compiled
def hanging(m: Numbers, f: Flaws, t: float, theta: float, omega: float) -> float:
    """Torque (N·m) of loads, springs, magnets and stops, positive forward."""
    torque = m.load_torque_nm + m.spring_nm_per_rad * (m.spring_rest_rad - theta)
    torque += f.mesh * 0.5 * (m.coulomb_forward_nm + m.coulomb_reverse_nm) * math.sin(f.mesh_cycles * theta)
    if m.gravity_torque_nm != 0.0 and t >= m.gravity_from_s:
        torque -= m.gravity_torque_nm * math.sin(theta + m.gravity_phase_rad)
    if m.cogging_torque_nm != 0.0:
        torque -= m.cogging_torque_nm * math.cos(m.cogging_cycles * theta + m.cogging_phase_rad)
    if m.stop_side != 0.0:
        depth = m.stop_side * (theta - m.stop_rad)
        if depth > 0.0:
            stiffness = m.inertia_kg_m2 * (2.0 * math.pi * STOP_HZ) ** 2
            damping = 2.0 * STOP_DAMPING * math.sqrt(stiffness * m.inertia_kg_m2)
            torque -= m.stop_side * max(0.0, stiffness * depth + damping * m.stop_side * omega)
    if m.stranger == CENTRIFUGAL_BRAKE and abs(omega) > m.b:
        torque -= math.copysign(m.a * (abs(omega) - m.b) ** 2, omega)
    return torque


@compiled
def coupling(m: Numbers, twist: float, rate: float) -> float:
    """Torque (N·m) that the hub puts on the second inertia: a shaft, or play between damped springs."""
    if m.gap_rad == 0.0:
        return m.shaft_stiffness_nm_per_rad * twist + m.shaft_damping_nm_s_per_rad * rate
    side = 1.0 if twist > 0.0 else -1.0
    depth = side * twist - 0.5 * m.gap_rad
    if depth <= 0.0:
        return 0.0
    reduced = m.inertia_kg_m2 * m.load_inertia_kg_m2 / (m.inertia_kg_m2 + m.load_inertia_kg_m2)
    stiffness = reduced * (2.0 * math.pi * 70.0) ** 2
    damping = 0.7 * math.sqrt(stiffness * reduced)
    return side * max(0.0, stiffness * depth + damping * side * rate)
