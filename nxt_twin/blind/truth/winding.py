"""Battery, bridge and winding: how fast the current changes."""

from __future__ import annotations

import math

from nxt_twin.blind.truth.compiled import compiled
from nxt_twin.blind.truth.motor import Motor

DRIVE, FLOAT, COAST, BRAKE = 0, 1, 2, 3
DECAY_S = 1e-4
BRUSH_ROUNDING_A = 0.005
FOLDBACK_V_PER_A = 300.0


@compiled
def terminal_v(motor: Motor, t: float, duty: float, current: float, mode: int) -> float:
    """The battery's voltage (V) under the bridge's draw: duty × winding current on average."""
    drawn = current * duty
    if mode == FLOAT:
        drawn = abs(current)
    elif mode != DRIVE:
        drawn = 0.0
    open_circuit = motor.battery_v - motor.drain_v_per_s * t
    return open_circuit - motor.internal_resistance_ohm * drawn


@compiled
def current_rate(
    motor: Motor, t: float, omega: float, current: float, heat: float, duty: float, mode: int
) -> float:
    """di/dt (A/s) of the mean winding current; `heat` is the relative rise of the resistance.

    drive: mean voltage duty·supply, the off phase shorted. float: the winding sees supply minus back-emf for
    the duty's share of the time, is open for the rest, and conducts only forwards.
    coast: open. brake: shorted.
    """
    if mode == COAST or (mode == FLOAT and duty == 0.0):
        return -current / DECAY_S
    emf = motor.back_emf_v_s_per_rad * omega
    supply = terminal_v(motor, t, duty, current, mode)
    against = motor.drop_v * math.tanh(current / BRUSH_ROUNDING_A)
    if mode == DRIVE:
        volts = duty * supply - emf - against
    elif mode == BRAKE:
        volts = -emf - against
    else:
        volts = abs(duty) * (math.copysign(supply, duty) - emf - against)
        if current * duty <= 0.0 and (math.copysign(supply, duty) - emf) * duty <= 0.0:
            return -current / DECAY_S
    if motor.current_limit_a > 0.0 and abs(current) > motor.current_limit_a:
        volts -= FOLDBACK_V_PER_A * (current - math.copysign(motor.current_limit_a, current))
    return (volts - motor.resistance_ohm * (1.0 + heat) * current) / motor.inductance_h
