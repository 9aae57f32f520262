"""Battery, bridge and winding: how fast the current changes."""

from __future__ import annotations

import math

from nxt_twin.blind.truth.compiled import compiled
from nxt_twin.blind.truth.motor import Motor

DRIVE, FLOAT, COAST, BRAKE = 0, 1, 2, 3
SETTLE_S = 2e-4
BRUSH_ROUNDING_A = 0.005
WHOLE_DROP = 20.0
"""So many widths of the rounding away from 0 A, nothing of it is left in the last digit."""
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
def _brush_drop(motor: Motor, current: float) -> float:
    """Voltage (V) lost at the brushes, against the current."""
    if motor.drop_v == 0.0:
        return 0.0
    ratio = current / BRUSH_ROUNDING_A
    if abs(ratio) > WHOLE_DROP:
        return math.copysign(motor.drop_v, ratio)
    return motor.drop_v * math.tanh(ratio)


@compiled
def current_rate(
    motor: Motor, t: float, omega: float, current: float, heat: float, duty: float, mode: int
) -> float:
    """di/dt (A/s) of the mean winding current; `heat` is the relative rise of the resistance.

    drive: mean voltage duty·supply, the off phase shorted. brake: shorted. coast: open.
    float: the current starts afresh in every PWM period, so inductance does not carry it on.
    """
    resistance = motor.resistance_ohm * (1.0 + heat)
    emf = motor.back_emf_v_s_per_rad * omega
    supply = terminal_v(motor, t, duty, current, mode)
    if mode == COAST:
        return -current / SETTLE_S
    if mode == FLOAT:
        return (_floating_current(motor, supply, emf, resistance, duty) - current) / SETTLE_S
    volts = duty * supply if mode == DRIVE else 0.0
    volts -= emf + _brush_drop(motor, current)
    if motor.current_limit_a > 0.0 and abs(current) > motor.current_limit_a:
        volts -= FOLDBACK_V_PER_A * (current - math.copysign(motor.current_limit_a, current))
    return (volts - resistance * current) / motor.inductance_h


@compiled
def _floating_current(motor: Motor, supply: float, emf: float, resistance: float, duty: float) -> float:
    """Mean current (A) with the off phase open: flows for the duty's share of the time, and only forwards."""
    if duty == 0.0:
        return 0.0
    side = math.copysign(1.0, duty)
    flowing = max(supply - side * emf - motor.drop_v, 0.0) / resistance
    if motor.current_limit_a > 0.0:
        flowing = min(flowing, motor.current_limit_a)
    return duty * flowing
