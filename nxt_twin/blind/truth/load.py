"""What hangs on the hub: torques from outside, a stop, a second inertia."""

from __future__ import annotations

import math

from nxt_twin.blind.truth.compiled import compiled
from nxt_twin.blind.truth.motor import Motor

GRAVITY_M_PER_S2 = 9.81
STOP_LOSS_S_PER_RAD = 0.08
STEEPEST_STOP = 12.0


@compiled
def outside_torque(motor: Motor, theta: float) -> float:
    """Torque (N·m) of weights, arms, rubber bands and magnets on the hub, positive forward."""
    torque = motor.constant_torque_nm
    if motor.arm_mass_kg != 0.0:
        lever_m = motor.arm_length_m * math.sin(theta + motor.arm_phase_rad)
        torque -= motor.arm_mass_kg * GRAVITY_M_PER_S2 * lever_m
    if motor.band_stiffness_nm_per_rad != 0.0:
        torque += motor.band_stiffness_nm_per_rad * (motor.band_rest_rad - theta)
    if motor.cogging_torque_nm != 0.0:
        torque += motor.cogging_torque_nm * math.sin(motor.cogging_cycles * theta + motor.cogging_phase_rad)
    return torque


@compiled
def stop_torque(motor: Motor, theta: float, omega: float) -> float:
    """Torque (N·m) of the mechanical stop: exponential in the penetration, higher on the way in than out."""
    if motor.stop_side == 0.0:
        return 0.0
    depth = motor.stop_side * (theta - motor.stop_rad)
    if depth <= 0.0:
        return 0.0
    squeeze = math.exp(min(depth / motor.stop_softness_rad, STEEPEST_STOP)) - 1.0
    loss = max(0.0, 1.0 + STOP_LOSS_S_PER_RAD * motor.stop_side * omega)
    return float(
        -motor.stop_side * motor.stop_stiffness_nm_per_rad * motor.stop_softness_rad * squeeze * loss
    )


@compiled
def coupling_torque(motor: Motor, twist: float, twist_rate: float) -> float:
    """Torque (N·m) that the hub puts on the second inertia: a damped spring, or play and Hertzian contact."""
    if motor.gap_rad == 0.0:
        return motor.shaft_stiffness_nm_per_rad * twist + motor.shaft_damping_nm_s_per_rad * twist_rate
    depth = abs(twist) - 0.5 * motor.gap_rad
    if depth <= 0.0:
        return 0.0
    side = math.copysign(1.0, twist)
    loss = max(0.0, 1.0 + motor.contact_loss_s_per_rad * side * twist_rate)
    return side * motor.contact_nm_per_rad15 * depth * math.sqrt(depth) * loss
