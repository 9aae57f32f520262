"""Dry friction: how high it stands, and how the bristles that carry it bend."""

from __future__ import annotations

import math

from nxt_twin.blind.truth.compiled import compiled
from nxt_twin.blind.truth.motor import Motor

SLOWEST_LEVEL_NM = 1e-9
STEEPEST = 2.0
DEAD_PACE = 28.0
"""Beyond it the damping is 0 to the last digit: its logarithm is below that of the smallest number."""


@compiled
def sliding_level(motor: Motor, t: float, theta: float, omega: float, carried: float, film: float) -> float:
    """The torque (N·m) at which friction slides, given the torque `carried` by the gear train.

    `film` is the state of the surprise that loses its lubricating film at low speed.
    """
    level = motor.coulomb_forward_nm if omega >= 0.0 else motor.coulomb_reverse_nm
    if motor.stiction_excess_nm != 0.0:
        ratio = abs(omega) / motor.stribeck_speed_rad_s
        if motor.stribeck_exponent > 0.0:
            level += motor.stiction_excess_nm * math.exp(-(ratio**motor.stribeck_exponent))
        else:
            level += motor.stiction_excess_nm / (1.0 + ratio * ratio)
    if motor.friction_per_torque != 0.0:
        level += motor.friction_per_torque * carried
    if motor.cold_extra_torque_nm != 0.0:
        level += motor.cold_extra_torque_nm * math.exp(-t / motor.warmup_time_s)
    if motor.binding_torque_nm != 0.0:
        swing = math.cos(motor.binding_cycles * theta + motor.binding_phase_rad)
        level += motor.binding_torque_nm * math.exp(motor.binding_sharpness * (swing - 1.0))
    return level + film


@compiled
def bristle_stiffness(motor: Motor) -> float:
    """The bristles' stiffness (N·m/rad): in a straight line, their reach gives Coulomb friction."""
    return min(motor.coulomb_forward_nm, motor.coulomb_reverse_nm) / motor.bristle_reach_rad


@compiled
def bristle_rate(motor: Motor, stiffness: float, level: float, omega: float, bend: float) -> float:
    """How fast the bristles bend (rad/s): Dahl's law with a free exponent."""
    if stiffness <= 0.0 or level <= SLOWEST_LEVEL_NM:
        return 0.0
    ratio = stiffness * bend / level
    yielding = min(abs(ratio), STEEPEST)
    if motor.bristle_exponent != 1.0:
        yielding **= motor.bristle_exponent
    return omega - abs(omega) * math.copysign(yielding, ratio)


@compiled
def bristle_torque(
    motor: Motor, stiffness: float, inertia: float, omega: float, bend: float, rate: float
) -> float:
    """Friction torque (N·m): the bent bristles' spring force, and damping that dies with speed."""
    if stiffness <= 0.0:
        return 0.0
    pace = omega / motor.bristle_damping_speed_rad_s
    if abs(pace) > DEAD_PACE:
        return stiffness * bend
    damping = 2.0 * motor.bristle_damping_ratio * math.sqrt(stiffness * inertia) * math.exp(-pace * pace)
    return stiffness * bend + damping * rate
