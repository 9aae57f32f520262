"""Physics that is in nobody's library of effects, to see whether a diagnosis admits that it does not know.

Each law is switched on by its number in `Motor.surprise` and has up to four numbers a, b, c, d of its own.
"""

from __future__ import annotations

import math

from nxt_twin.blind.truth.compiled import compiled
from nxt_twin.blind.truth.motor import Motor

(
    NOTHING,
    SWITCHING_DETENT,
    ANGLE_SPEED_DRAG,
    AMPLIFIER_MEMORY,
    RESONANT_FAN,
    BELT_SLIP,
    PERIODIC_PUSH,
    SHAKEN_GREASE,
    SWAPPED_SENSE,
    ONE_SIDED_RIPPLE,
    PAWL,
    RISING_SLEW,
    THERMAL_FOLDBACK,
    SPEED_BAND_PUSH,
    LOST_FILM,
) = range(15)

SLIP_ROUNDING_RAD_S = 0.05
QUICK_PER_S = 2000.0
FILM_PER_S = 20.0
SPENT_DUTY = 1e-3


@compiled
def hub_torque(motor: Motor, t: float, theta: float, omega: float, omega_load: float, memory: float) -> float:
    """Torque (N·m) of the surprise on the hub, positive forward."""
    kind = int(motor.surprise)
    a, b, c, d = motor.surprise_a, motor.surprise_b, motor.surprise_c, motor.surprise_d
    if kind == SWITCHING_DETENT:
        return -a * math.sin(b * theta + d) / (1.0 + math.exp((abs(omega) - c) / (0.15 * c)))
    if kind == ANGLE_SPEED_DRAG:
        return -a * omega * math.sin(b * theta + d)
    if kind == RESONANT_FAN:
        return -a * omega * abs(omega) * (1.0 + b / (1.0 + ((abs(omega) - c) / d) ** 2))
    if kind == BELT_SLIP:
        return -b * math.tanh((omega - omega_load) / SLIP_ROUNDING_RAD_S)
    if kind == PERIODIC_PUSH:
        since = (t - d) % b
        return a * math.sin(math.pi * since / c) ** 2 if since < c else 0.0
    if kind == SHAKEN_GREASE:
        return -a * omega / (1.0 + memory / c)
    if kind == PAWL:
        caught = 0.5 * (1.0 + math.tanh(6.0 * math.sin(b * theta + d)))
        return -a * math.tanh(min(omega, 0.0) / c) * caught
    if kind == SPEED_BAND_PUSH:
        return math.copysign(a, omega) * math.exp(-(((abs(omega) - b) / c) ** 2))
    return 0.0


@compiled
def torque_ripple(motor: Motor, theta: float, current: float) -> float:
    """Factor on the torque constant."""
    if int(motor.surprise) != ONE_SIDED_RIPPLE or current <= 0.0:
        return 1.0
    return 1.0 + motor.surprise_a * math.sin(motor.surprise_b * theta + motor.surprise_d)


@compiled
def duty_in_force(motor: Motor, duty: float, memory: float) -> float:
    """The duty that the bridge makes of the command."""
    kind = int(motor.surprise)
    if kind == RISING_SLEW:
        return memory
    if kind == THERMAL_FOLDBACK:
        return duty / (1.0 + (max(memory, 0.0) / motor.surprise_a) ** 8)
    return duty


@compiled
def film_torque(motor: Motor, memory: float) -> float:
    """Sliding friction (N·m) added while the lubricating film is lost (memory 0: lost, 1: whole)."""
    return motor.surprise_a * (1.0 - memory) if int(motor.surprise) == LOST_FILM else 0.0


@compiled
def count_rate(motor: Motor, t: float, omega: float) -> float:
    """The rate that the swapped encoder adds to its count (rad/s)."""
    if int(motor.surprise) == SWAPPED_SENSE and (t - motor.surprise_c) % motor.surprise_a < motor.surprise_b:
        return -2.0 * omega
    return 0.0


@compiled
def memory_rate(
    motor: Motor, omega: float, current: float, duty: float, memory: float, acceleration: float
) -> float:
    """How fast the surprise's own state changes."""
    kind = int(motor.surprise)
    if kind == SHAKEN_GREASE:
        return (abs(acceleration) - memory) / motor.surprise_b
    if kind == RISING_SLEW:
        goal = duty if duty * memory >= 0.0 or abs(memory) < SPENT_DUTY else 0.0
        wanted = QUICK_PER_S * (goal - memory)
        if abs(goal) < abs(memory):
            return wanted
        return min(max(wanted, -motor.surprise_a), motor.surprise_a)
    if kind == THERMAL_FOLDBACK:
        return current * current - memory / motor.surprise_b
    if kind == LOST_FILM:
        goal = memory
        if abs(omega) > motor.surprise_b:
            goal = 1.0
        elif abs(omega) < motor.surprise_c:
            goal = 0.0
        return FILM_PER_S * (goal - memory)
    return 0.0


@compiled
def load_rate(motor: Motor, omega: float, omega_load: float) -> float:
    """Acceleration (rad/s²) of the wheel behind the slipping belt."""
    pull = motor.surprise_b * math.tanh((omega - omega_load) / SLIP_ROUNDING_RAD_S)
    return (pull - motor.surprise_c * omega_load * abs(omega_load)) / motor.surprise_a
