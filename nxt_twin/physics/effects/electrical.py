"""Battery, bridge, brushes and winding."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import NUMBER, Parameter


def _sag(duty: float, internal: float) -> float:
    return internal * duty * duty


BATTERY_SAG = Effect(
    id="battery_sag",
    name="battery sag",
    equation="U = u·(Ub - Ri·|u|·i): the bridge draws |u|·i from the battery, so the winding sees Ri·u² in series",
    equation_of="electrical",
    shows=("high_current", "after_command"),
    parameters=(Parameter("internal_resistance_ohm", "internal", "Ω", NUMBER, (0.8, 2.5), 0.0, 20.0),),
    terms={"resistance": _sag},
    confusable_with={
        "load_dependent_friction": "fast battery readings at high current tell: friction leaves the supply alone"
    },
    frames=("motor",),
    inputs=("power_pct",),
)


def _drop(brush_drop: float) -> float:
    return brush_drop


VOLTAGE_DROP = Effect(
    id="voltage_drop",
    name="bridge or brush voltage drop",
    equation="U = u·Ub - Ud·sign(i), no current within ±Ud",
    equation_of="electrical",
    shows=("low_speed", "direction"),
    parameters=(Parameter("drop_v", "brush_drop", "V", NUMBER, (0.4, 1.0), 0.0, 5.0),),
    terms={"drop": _drop},
    confusable_with={
        "coulomb_friction": "a coast-down without current tells: friction brakes it, a drop does not",
        "load_dependent_friction": "small commands held at rest tell a dead zone in voltage from one in torque",
    },
    frames=("motor",),
    inputs=("power_pct", "voltage_v"),
)


def _power_law(duty: float, exponent: float) -> float:
    return math.copysign(abs(duty) ** exponent, duty)


POWER_CURVE = Effect(
    id="power_curve",
    name="nonlinear duty",
    equation="U = Ub·sign(u)·|u|^n",
    equation_of="electrical",
    shows=("after_command", "high_speed"),
    parameters=(Parameter("exponent", "exponent", "1", NUMBER, (1.3, 0.8), 0.3, 3.0, spread=1.0),),
    terms={"duty": _power_law},
    confusable_with={"voltage_drop": "several levels of power tell the curve from a constant drop"},
    frames=("motor",),
    inputs=("power_pct",),
)


def _inductance(winding: float) -> float:
    return winding


INDUCTANCE = Effect(
    id="inductance",
    name="winding inductance",
    equation="U = e + R·i + L·di/dt (Gonçalves et al., equation 1)",
    equation_of="electrical",
    shows=("after_command",),
    parameters=(Parameter("inductance_h", "winding", "H", NUMBER, (4.88e-3, 0.05), 0.0, 2.0, frozen=True),),
    terms={"inductance": _inductance},
    confusable_with={"command_delay": "below two samples nothing tells them apart; poll faster"},
    frames=("motor",),
    inputs=("power_pct", "voltage_v"),
    plain=True,
)


def _limit(limit: float, ceiling: float) -> float:
    return min(limit, ceiling)


CURRENT_LIMIT = Effect(
    id="current_limit",
    name="current limit of the driver",
    equation="|i| ≤ imax (Gonçalves et al., figure 9)",
    equation_of="electrical",
    shows=("high_current", "after_command"),
    parameters=(Parameter("current_limit_a", "ceiling", "A", NUMBER, (0.6, 0.3, 1.0), 0.02, 20.0),),
    terms={"limit": _limit},
    confusable_with={"battery_sag": "steps of several sizes tell: a limit bites only the large ones"},
    frames=("motor",),
    inputs=("power_pct", "voltage_v"),
    plain=True,
)
