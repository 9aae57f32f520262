"""A geared permanent-magnet DC motor behind a PWM bridge, quantities at the output hub.

Gonçalves et al., equations 1 to 4 and 7 to 10; friction, inductance and the current limit are effects.
"""

from __future__ import annotations

import math

from nxt_twin.physics.base.base import Base
from nxt_twin.physics.modes import MODE_BRAKE, MODE_COAST, MODE_CURRENT, MODE_FLOAT, MODE_VOLTAGE
from nxt_twin.physics.parameter import INERTIA, NUMBER, Parameter


def drive(
    duty: float,
    mode: int,
    supply_v: float,
    resistance: float,
    inductance: float,
    torque_constant: float,
    back_emf: float,
    drop: float,
    knee: float,
    limit: float,
    speed: float,
    current: float,
    step_s: float,
) -> tuple[float, float]:
    """Torque at zero speed (N·m) and electrical damping (N·m·s/rad) over one step.

    The winding current of the step's middle follows from the trapezoidal rule on equation 1,
    U = Ke·ω + R·i + L·di/dt. The terminal voltage never exceeds the supply, since the duty is bounded. A `drop`
    opposes the current. It grows with it, is half there at the current `knee`, and so ends at zero current. A current
    beyond `limit` stays at the limit.

    Modes: drive (off phase shorted: mean voltage duty·supply), coast (open) and brake (shorted). In float the off phase
    is open: the winding conducts for the duty's fraction of the time, and only forwards. On a bench, `duty` is a given
    voltage or current.
    """
    if mode == MODE_CURRENT:
        return torque_constant * min(max(duty, -limit), limit), 0.0
    if mode == MODE_COAST or (mode == MODE_FLOAT and duty == 0.0):
        return 0.0, 0.0
    share = 1.0
    if mode == MODE_VOLTAGE:
        source = min(max(duty, -supply_v), supply_v)
    elif mode == MODE_BRAKE:
        source = 0.0
    elif mode == MODE_FLOAT:
        source = math.copysign(supply_v, duty)
        share = abs(duty)
        if (source - back_emf * speed) * duty <= 0.0:
            return 0.0, 0.0
    else:
        source = duty * supply_v
    lag = 0.0 if mode == MODE_FLOAT else 2.0 * inductance / step_s
    impedance = resistance + lag
    if drop > 0.0 or limit < math.inf:
        net = source - back_emf * speed
        lost = _lost(abs(net), drop, resistance * knee)
        source -= math.copysign(lost, net)
        net -= math.copysign(lost, net)
        if abs(net + lag * current) > limit * impedance:
            return torque_constant * share * math.copysign(limit, net + lag * current), 0.0
    gain = torque_constant * share * (1.0 / impedance)
    return gain * (source + lag * current), gain * back_emf


def _lost(net: float, drop: float, knee_v: float) -> float:
    """What a drop takes of the voltage `net` that drives a current, where R·i + drop·i/(i + knee) is that voltage.

    Without a knee, all of the drop or all of the voltage. A winding's inductance is left out of it.
    """
    spare = net - drop - knee_v
    return net - 0.5 * (spare + math.sqrt(spare * spare + 4.0 * net * knee_v))


def current_after(
    mode: int,
    force: float,
    coupling: float,
    before: float,
    after: float,
    current: float,
    inductance: float,
    torque_constant: float,
) -> float:
    """The winding current (A) at the end of a step, from that of its middle and of its beginning.

    Without inductance, or where nothing carries the current on, the middle's stands for the step.
    """
    middle = (force - 0.5 * coupling * (before + after)) * (1.0 / torque_constant)
    if inductance <= 0.0 or coupling == 0.0 or mode == MODE_FLOAT:
        return middle
    return 2.0 * middle - current


def drawn_by_others(
    open_circuit_v: float, others_share: float, others_speed: float, resistance: float, back_emf: float
) -> tuple[float, float]:
    """What other motors of this make draw (A) at the supply's open-circuit voltage, and how that falls with it (S).

    `physics.others` tells what their shares and speeds are. Negative where they are quicker than they are driven.
    """
    fall = others_share / resistance
    return fall * open_circuit_v - others_speed * back_emf / resistance, fall


DC_MOTOR = Base(
    kind="dc_motor",
    frames=("motor",),
    parameters=(
        Parameter("inertia_kg_m2", "inertia", "kg·m²", INERTIA, (1.2e-3,), 1e-5, 0.2, doubt=0.7),
        Parameter("resistance_ohm", "resistance", "Ω", NUMBER, (7.6,), 0.05, 500.0, doubt=0.12),
        Parameter(
            "torque_constant_nm_per_a",
            "torque_constant",
            "N·m/A",
            NUMBER,
            (0.4908,),
            1e-3,
            50.0,
            doubt=0.15,
        ),
        Parameter(
            "back_emf_v_s_per_rad",
            "back_emf",
            "V·s/rad",
            NUMBER,
            (0.4908,),
            1e-3,
            50.0,
            tied_to="torque_constant",
        ),
        Parameter("supply_v", "supply_v", "V", NUMBER, (8.0,), 0.5, 60.0, frozen=True, otherwise=8.0),
    ),
    drive=drive,
    current_after=current_after,
    drawn_by_others=drawn_by_others,
)
