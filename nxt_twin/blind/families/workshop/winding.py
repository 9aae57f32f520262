"""Battery, bridge and winding of this family."""

from __future__ import annotations

import math

from nxt_twin.blind.families.compiled import compiled
from nxt_twin.blind.families.numbers import Numbers
from nxt_twin.blind.families.workshop.torques import WORN_SEGMENT

FLOAT, COAST, BRAKE = 1, 2, 3
OPEN_WINDING_S = 1.5e-4


@compiled
def drawn_a(current: float, duty: float, mode: int) -> float:
    """The bridge's current from the battery, A."""
    if mode >= COAST:
        return 0.0
    return abs(current) if mode == FLOAT else current * duty


@compiled
def volts(m: Numbers, t: float, drawn: float, dip_v: float) -> float:
    """The battery's voltage under load, V."""
    return m.supply_v - m.drain_v_per_s * t - dip_v - m.internal_resistance_ohm * drawn


@compiled
def resistance(m: Numbers, theta: float, heat: float) -> float:
    """Of the winding, ohm."""
    ohm = m.resistance_ohm * (1.0 + heat)
    if m.stranger == WORN_SEGMENT and math.sin(m.b * theta + m.d) > m.c:
        ohm *= 1.0 + m.a
    return ohm


@compiled
def next_current(
    m: Numbers, h: float, current: float, ohm: float, emf: float, supply: float, duty: float, mode: int
) -> float:
    """The mean current after a step of `h` seconds, implicit in the current, A."""
    if mode == COAST:
        return current / (1.0 + h / OPEN_WINDING_S)
    if mode == FLOAT:
        side = 1.0 if duty > 0.0 else -1.0
        pulse = side * duty * max(0.0, supply - side * emf - m.drop_v) / ohm
        goal = side * (min(pulse, m.current_limit_a) if m.current_limit_a > 0.0 else pulse)
        return (current + h / OPEN_WINDING_S * goal) / (1.0 + h / OPEN_WINDING_S)
    pushed = current + h / m.inductance_h * ((duty * supply if mode == 0 else 0.0) - emf)
    held = h / m.inductance_h * m.drop_v
    if abs(pushed) <= held:
        return 0.0
    after = (pushed - math.copysign(held, pushed)) / (1.0 + h * ohm / m.inductance_h)
    if m.current_limit_a > 0.0:
        after = min(max(after, -m.current_limit_a), m.current_limit_a)
    return after
