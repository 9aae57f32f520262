"""Battery, bridge, brushes and winding."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.inline import power
from nxt_twin.physics.modes import MODE_FLOAT
from nxt_twin.physics.parameter import CURRENT, ENERGY_INVERSE, NUMBER, RESISTANCE, VOLTAGE, Parameter

if TYPE_CHECKING:
    from nxt_twin.physics.signals import Signals

_UNREAD_V = 0.07


def _sag(duty: float, mode: int, others_s: float, internal: float) -> float:
    return _beside(internal, others_s) * (abs(duty) if mode == MODE_FLOAT else duty * duty)


def _lowered(supply_v: float, others_a: float, others_s: float, internal: float) -> float:
    return supply_v - _beside(internal, others_s) * others_a


def _beside(internal: float, others_s: float) -> float:
    """Where the supply falls, the others draw the less: their windings are beside the internal resistance."""
    return internal / (1.0 + internal * others_s)


BATTERY_SAG = Effect(
    id="battery_sag",
    name="battery sag",
    equation="U = u·(Ub - Ri·(|u|·i + io)): the bridge draws |u|·i, the brick's other motors io; "
    "the winding sees Ri·u² in series, floating Ri·|u|",
    source="a battery as a source with an internal resistance",
    equation_of="electrical",
    shows=("high_current", "after_command"),
    notable=0.12,
    parameters=(Parameter("internal_resistance_ohm", "internal", "Ω", RESISTANCE, (0.8, 2.5), 0.0, 20.0),),
    terms={"supply": _lowered, "resistance": _sag},
    confusable_with={
        "load_dependent_friction": "fast battery readings at high current tell: friction leaves the supply alone"
    },
    frames=("motor",),
    inputs=("power_pct",),
)


def _drop(brush_drop: float) -> float:
    return brush_drop


def _knee(drop_knee: float) -> float:
    return drop_knee


VOLTAGE_DROP = Effect(
    id="voltage_drop",
    name="bridge or brush voltage drop",
    equation="U = u·Ub - Ud·i/(|i| + Ik)",
    source="the contact drop of brushes and of a bipolar bridge, constant but for the smallest currents",
    equation_of="electrical",
    shows=("low_speed", "direction"),
    notable=0.06,
    parameters=(
        Parameter("drop_v", "brush_drop", "V", VOLTAGE, (0.4, 1.0), 0.0, 5.0, law=0.05),
        Parameter(
            "drop_knee_a",
            "drop_knee",
            "A",
            CURRENT,
            (0.01,),
            0.0,
            1.0,
            spread=1.5,
            otherwise=0.0,  # a step: all of the drop at any current
        ),
    ),
    terms={"drop": _drop, "knee": _knee},
    confusable_with={
        "coulomb_friction": "a coast-down without current tells: friction brakes it, a drop does not",
        "load_dependent_friction": "small commands held at rest tell a dead zone in voltage from one in torque",
    },
    frames=("motor",),
    inputs=("power_pct", "voltage_v"),
)


_BENT = 0.05  # how far the exponent commonly changes from no power to full, one standard deviation
_FLATTEST = 0.05  # exponent


def _power_law(duty: float, exponent: float, bend: float) -> float:
    size = abs(duty)
    return math.copysign(power(size, max(exponent + bend * (size - 0.5), _FLATTEST)), duty)


POWER_CURVE = Effect(
    id="power_curve",
    neutral=1.0,
    notable=0.015,
    name="nonlinear power curve",
    equation="U = Ub·sign(u)·|u|^(n + b·(|u| - ½))",
    source="our own: the simplest curve through 0 and full power, and how a driver's own bends from it",
    equation_of="electrical",
    shows=("after_command", "high_speed"),
    parameters=(
        Parameter("exponent", "exponent", "1", NUMBER, (1.3, 0.8), 0.3, 3.0, spread=1.0),
        Parameter("bend", "bend", "1", NUMBER, (0.0,), -1.5, 1.5, _BENT, otherwise=0.0, shapes=True),
    ),
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
    equation="U = e + R·i + L·di/dt",
    source="Gonçalves et al., equation 1",
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
    equation="|i| ≤ imax",
    source="Gonçalves et al., figure 9",
    equation_of="electrical",
    shows=("high_current", "after_command"),
    parameters=(Parameter("current_limit_a", "ceiling", "A", CURRENT, (0.6, 0.3, 1.0), 0.02, 20.0),),
    terms={"limit": _limit},
    confusable_with={"battery_sag": "steps of several sizes tell: a limit bites only the large ones"},
    frames=("motor",),
    inputs=("power_pct", "voltage_v"),
    plain=True,
)


def _drained(supply_v: float, elapsed_s: float, drain: float) -> float:
    return supply_v - drain * elapsed_s


def _unread_drain(recordings: Sequence[Signals]) -> float:
    """The supply is a line through readings, which load and rest move by some counts of 13.9 mV within a recording."""
    return _UNREAD_V / max(float(signals.time_s[-1] - signals.time_s[0]) for signals in recordings)


BATTERY_DRAIN = Effect(
    id="battery_drain",
    name="battery drain",
    equation="Ub = U0 - d·t, t since the recording began",
    source="the flat middle of a discharge curve, as a straight line",
    equation_of="electrical",
    shows=("elapsed_time", "high_speed"),
    parameters=(
        Parameter("drain_v_per_s", "drain", "V/s", VOLTAGE, (0.03, 0.1), 0.0, 2.0, least=_unread_drain),
    ),
    terms={"supply": _drained},
    confusable_with={
        "winding_heating": "a rest tells: a winding cools in it, a battery stays low; or read the battery often",
        "friction_warmup": "opposite signs: a draining battery slows the motor with time, running in speeds it up",
    },
    frames=("motor",),
    inputs=("power_pct",),
)


def _heated(resistance: float, warm: float) -> float:
    return resistance * warm


def _warmer(
    warm: float, current: float, resistance: float, step_s: float, rise: float, thermal_time: float
) -> float:
    return warm + step_s * (rise * resistance * current * current - warm / thermal_time)


WINDING_HEATING = Effect(
    id="winding_heating",
    name="winding heating",
    equation="R = R0·(1 + w), dw/dt = r·R·i² - w/T",
    source="one thermal mass; copper gains 0.393 % of its resistance a kelvin (IEC 60028)",
    equation_of="electrical",
    shows=("elapsed_time", "high_current"),
    notable=0.0005,
    parameters=(
        Parameter("resistance_rise_per_joule", "rise", "1/J", ENERGY_INVERSE, (0.01, 0.05, 2e-3), 0.0, 1.0),
        # The heat may be that of the cold resistance or of the warm one, which makes the more the warmer it is.
        Parameter(
            "thermal_time_constant_s",
            "thermal_time",
            "s",
            NUMBER,
            (45.0,),
            2.0,
            1000.0,
            spread=2.0,
            law=0.3,
        ),
    ),
    terms={"resistance": _heated, "advance": _warmer},
    states=("warm",),
    lasting=("warm",),
    confusable_with={
        "battery_drain": "a rest tells: a winding cools in it, a battery stays low; or read the battery often",
        "battery_sag": "the same push early and late tells: sag is there at once, heat comes with time",
        "friction_warmup": "opposite signs: a hot winding slows the motor with time, running in speeds it up",
    },
    frames=("motor",),
    inputs=("power_pct", "voltage_v"),
)
