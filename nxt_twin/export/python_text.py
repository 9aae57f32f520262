"""A motor as a Python module that needs nothing else."""

from __future__ import annotations

from nxt_twin.export.axis import Axis

_MODULE = '''"""{told}"""

import math

RESISTANCE_OHM = {resistance_ohm!r}
INDUCTANCE_H = {inductance_h!r}
TORQUE_CONSTANT_NM_PER_A = {torque_constant_nm_per_a!r}
BACK_EMF_V_S_PER_RAD = {back_emf_v_s_per_rad!r}
INERTIA_KG_M2 = {inertia_kg_m2!r}
COULOMB_FRICTION_NM = {coulomb_friction_nm!r}
VISCOUS_FRICTION_NM_S_PER_RAD = {viscous_friction_nm_s_per_rad!r}
SUPPLY_V = {supply_v!r}


def step(state, voltage_v, dt_s, *, closed=True, load_nm=0.0):
    """Advance (angle rad, speed rad/s, current A) by one step of the trapezoidal rule.

    Args:
        state: angle, speed and current before.
        voltage_v: at the winding, the mean of the pulses.
        dt_s: the step; 1 ms is short enough.
        closed: False for an open winding: the motor coasts. A closed one at 0 V brakes.
        load_nm: what the hub has to hold against.

    Returns:
        Angle, speed and current after.
    """
    angle, speed, current = state
    lag = 2.0 * INDUCTANCE_H / dt_s
    gain = TORQUE_CONSTANT_NM_PER_A / (RESISTANCE_OHM + lag) if closed else 0.0
    push = gain * (voltage_v + lag * current) - load_nm
    damping = VISCOUS_FRICTION_NM_S_PER_RAD + gain * BACK_EMF_V_S_PER_RAD
    weight = INERTIA_KG_M2 / dt_s + 0.5 * damping
    free = (speed * (INERTIA_KG_M2 / dt_s - 0.5 * damping) + push) / weight
    after = math.copysign(max(0.0, abs(free) - COULOMB_FRICTION_NM / weight), free)
    middle = 0.5 * (speed + after)
    if closed:
        mean = (gain * (voltage_v + lag * current) - gain * BACK_EMF_V_S_PER_RAD * middle) / TORQUE_CONSTANT_NM_PER_A
        current = 2.0 * mean - current if INDUCTANCE_H > 0.0 else mean
    else:
        current = 0.0
    return angle + dt_s * middle, after, current
'''


def python_text(axis: Axis, told: tuple[str, ...]) -> str:
    """Constants, and a function that advances the motor by one step."""
    lines = [f"{line[:1].upper()}{line[1:]}." for line in told]
    return _MODULE.format(told="\n".join((lines[0], "", *lines[1:], "")), **vars(axis))
