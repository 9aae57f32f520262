"""What hangs on the axis: weights, arms, springs."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import ANGLE, NUMBER, STIFFNESS, TORQUE, Parameter


def _constant(load: float) -> float:
    return load


CONSTANT_LOAD = Effect(
    id="constant_load",
    name="constant load",
    equation="τ = τ0, a steady torque such as a hanging weight's",
    equation_of="torque_balance",
    shows=("direction", "low_speed"),
    parameters=(
        Parameter(
            "load_torque_nm",
            "load",
            "N·m",
            TORQUE,
            (0.02, -0.02),
            -3.0,
            3.0,
            elsewhere={"linear": ("load_force_n", "N")},
        ),
    ),
    terms={"torque": _constant},
    confusable_with={
        "asymmetric_friction": "a rest at small commands both ways: a load still pushes there, friction does not",
        "gravity_load": "a whole turn tells: gravity changes sign within it",
    },
)


def _gravity(angle: float, gravity: float, phase: float) -> float:
    return -gravity * math.sin(angle + phase)


GRAVITY_LOAD = Effect(
    id="gravity_load",
    name="unbalanced arm",
    equation="τ = -τg·sin(θ + φ)",
    equation_of="torque_balance",
    shows=("angle",),
    parameters=(
        Parameter("gravity_torque_nm", "gravity", "N·m", TORQUE, (0.05,), 0.0, 3.0),
        Parameter(
            "phase_deg", "phase", "deg", NUMBER, (0.0, 90.0, 180.0, -90.0), -270.0, 270.0, si=math.pi / 180.0
        ),
    ),
    terms={"torque": _gravity},
    confusable_with={"spring_load": "several turns tell: a spring winds up, gravity comes round again"},
    frames=("motor", "rotary"),
)


def _spring(angle: float, stiffness: float, rest: float) -> float:
    return -stiffness * (angle - rest)


SPRING_LOAD = Effect(
    id="spring_load",
    name="elastic load",
    equation="τ = -k·(θ - θ0), such as a rubber band's",
    equation_of="torque_balance",
    shows=("angle",),
    parameters=(
        Parameter(
            "stiffness_nm_per_rad",
            "stiffness",
            "N·m/rad",
            STIFFNESS,
            (4e-3, 4e-4),
            0.0,
            0.5,
            elsewhere={"linear": ("stiffness_n_per_m", "N/m")},
        ),
        Parameter(
            "rest_angle_deg",
            "rest",
            "deg",
            ANGLE,
            (0.0,),
            -36000.0,
            36000.0,
            si=math.pi / 180.0,
            elsewhere={"linear": ("rest_position_m", "m", 1.0)},
        ),
    ),
    terms={"torque": _spring},
    confusable_with={"gravity_load": "several turns tell: a spring winds up, gravity comes round again"},
)
