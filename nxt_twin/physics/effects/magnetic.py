"""What iron and commutator make of the current: torque that yields, torque that ripples."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.inline import cosine
from nxt_twin.physics.parameter import CURRENT_INVERSE, NUMBER, Parameter


def _yielded(drive_torque: float, current: float, saturation: float) -> float:
    load = saturation * abs(current)
    return -drive_torque * load / (1.0 + load)


TORQUE_SATURATION = Effect(
    id="torque_saturation",
    name="torque saturation",
    equation="τ = Kt·i/(1 + y·|i|)",
    source="Fröhlich's curve of iron that saturates, in the torque constant",
    equation_of="torque_balance",
    shows=("high_current", "after_command"),
    notable=0.03,
    parameters=(
        Parameter("torque_yield_per_a", "saturation", "1/A", CURRENT_INVERSE, (0.5, 0.15), 0.0, 20.0),
    ),
    terms={"torque": _yielded},
    confusable_with={
        "current_limit": "steps of several sizes tell: a limit is sharp, iron yields from the first ampere",
        "battery_sag": "top speed tells: a sagging supply lowers it, a torque that yields hardly does",
        "load_dependent_friction": "being pushed tells: friction brakes what the load drives, a weak torque does not",
        "winding_heating": "the same push early and late tells: iron yields at once, heat comes with time",
    },
    frames=("motor",),
)


def _commutated(
    drive_torque: float, angle: float, ripple: float, commutations: float, ripple_phase: float
) -> float:
    return drive_torque * ripple * cosine(commutations * angle + ripple_phase)


COMMUTATION_RIPPLE = Effect(
    id="commutation_ripple",
    name="commutation ripple",
    equation="τ = Kt·i·(1 + r·cos(n·θ + φ)), n ≥ 2",
    source="Hanselman 2003; the first harmonic of the torque between two commutations",
    equation_of="torque_balance",
    shows=("angle", "high_current"),
    notable=0.05,
    parameters=(
        Parameter("ripple_fraction", "ripple", "1", NUMBER, (0.15,), 0.0, 1.0),
        Parameter(
            "cycles_per_turn",
            "commutations",
            "1",
            NUMBER,
            (2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 18.0, 24.0, 36.0),
            1.5,
            100.0,
        ),
        Parameter(
            "phase_deg",
            "ripple_phase",
            "deg",
            NUMBER,
            (0.0, 120.0, -120.0),
            -360.0,
            360.0,
            si=math.pi / 180.0,
            otherwise=0.0,
        ),
    ),
    terms={"torque": _commutated},
    confusable_with={
        "cogging": "a coast-down without current tells: cogging is still there, commutation ripple is not",
        "angle_dependent_friction": "several powers at one speed tell: binding stays, ripple grows with the current",
    },
    frames=("motor", "rotary"),
)
