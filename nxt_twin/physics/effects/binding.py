"""Friction that remembers or repeats: bristles that bend before they slide, and gears that bind once a turn."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.effects.bristles import bent, bristle_torque
from nxt_twin.physics.inline import cosine, power
from nxt_twin.physics.parameter import ANGLE, NUMBER, TORQUE, Parameter

PRESLIDING = Effect(
    id="presliding",
    name="presliding",
    equation="τ = -|τ sliding|·z, r·dz/dt = ω - |ω|·z, in the place of sticking; r the displacement, |z| ≤ 1",
    source="Dahl 1968; the bristles of Canudas de Wit et al. 1995 without their damping",
    equation_of="torque_balance",
    shows=("reversal", "low_speed"),
    notable=0.5,
    parameters=(
        Parameter(
            "presliding_deg",
            "reach",
            "deg",
            ANGLE,
            (4.0, 1.5, 10.0),
            0.5,
            60.0,
            spread=3.0,
            si=math.pi / 180.0,
            elsewhere={"linear": ("presliding_mm", "mm", 1e-3)},
            law=0.1,  # Dahl's exponent from 1 to 2, at the same stiffness, reads as a reach up to a fifth shorter
        ),
    ),
    terms={"hold": bristle_torque, "advance": bent},
    states=("bend",),
    confusable_with={
        "backlash": "a pause without drive after a push tells: bent bristles spring back, play stays where it is",
        "stiction": "pushes below breakaway tell: bristles give a little and return, a stuck axis does not move",
        "shaft_compliance": "small fast reversals tell: a second mass rings, bristles only yield",
    },
)


def _binding(
    level: float, angle: float, binding: float, cycles: float, phase: float, sharpness: float
) -> float:
    nearness = 0.5 + 0.5 * cosine(cycles * angle + phase)
    return level + binding * power(nearness, sharpness)


ANGLE_DEPENDENT_FRICTION = Effect(
    id="angle_dependent_friction",
    name="angle-dependent friction",
    equation="|τ| = Tc + Tb·((1 + cos(n·θ + φ))/2)^p, n tight places a turn",
    source="our own: the simplest periodic bump with a free width",
    equation_of="torque_balance",
    shows=("angle", "low_speed"),
    notable=0.002,
    parameters=(
        Parameter(
            "binding_torque_nm",
            "binding",
            "N·m",
            TORQUE,
            (0.03,),
            0.0,
            3.0,
            law=0.05,  # the height of a bump hangs on its shape
        ),
        Parameter("cycles_per_turn", "cycles", "1", NUMBER, (1.0, 2.0, 3.0, 4.0, 6.0), 0.5, 60.0),
        Parameter(
            "phase_deg",
            "phase",
            "deg",
            NUMBER,
            (0.0, 90.0, 180.0, -90.0),
            -360.0,
            360.0,
            si=math.pi / 180.0,
            otherwise=0.0,
        ),
        Parameter("sharpness", "sharpness", "1", NUMBER, (4.0,), 0.5, 40.0, spread=1.0, otherwise=4.0),
    ),
    terms={"friction": _binding},
    confusable_with={
        "gravity_load": "turning both ways tells: friction brakes both, an arm pushes one way and brakes the other",
        "cogging": "turning both ways tells: friction brakes both, cogging pushes one way and brakes the other",
        "encoder_eccentricity": "the same turns at several speeds tell: a torque fades with speed, a reading does not",
    },
    frames=("motor", "rotary"),
)
