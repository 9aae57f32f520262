"""A mechanical limit: one that turns the speed round at once, or a bumper that gives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import ANGLE, GIVE, NUMBER, Parameter
from nxt_twin.physics.signals import Signals

_SUDDEN: Final = 0.01  # least restitution: below it a contact is as good as critically damped


def _bounce(
    angle: float, speed: float, home: float, limit: float, restitution: float, give: float
) -> tuple[float, float]:
    side = 1.0 if limit >= home else -1.0
    beyond = side * (angle - limit)
    if beyond <= 0.0 or give > 0.0:
        return angle, speed
    if side * speed <= 0.0:
        return limit, speed
    return limit - side * restitution * beyond, -restitution * speed


def _bumper(
    angle: float,
    speed: float,
    step_s: float,
    inertia: float,
    home: float,
    limit: float,
    restitution: float,
    give: float,
) -> tuple[float, float]:
    """How far a stop that gives is pushed in, times its stiffness, and its damping; none where it does not push."""
    side = 1.0 if limit >= home else -1.0
    beyond = side * (angle - limit)
    if beyond <= 0.0 or give <= 0.0:
        return 0.0, 0.0
    stiffness = min(1.0 / give, inertia / (step_s * step_s))  # beyond that the step is unstable
    bounce = math.log(max(restitution, _SUDDEN))
    damping = -2.0 * bounce / math.sqrt(math.pi**2 + bounce * bounce) * math.sqrt(stiffness * inertia)
    if stiffness * beyond + damping * side * speed <= 0.0:
        return 0.0, 0.0
    return side * stiffness * beyond, damping


def _pushed_back(
    angle: float,
    speed: float,
    step_s: float,
    inertia: float,
    home: float,
    limit: float,
    restitution: float,
    give: float,
) -> float:
    return -_bumper(angle, speed, step_s, inertia, home, limit, restitution, give)[0]


def _cushioned(
    angle: float,
    speed: float,
    step_s: float,
    inertia: float,
    home: float,
    limit: float,
    restitution: float,
    give: float,
) -> float:
    return _bumper(angle, speed, step_s, inertia, home, limit, restitution, give)[1]


def _reached(recordings: Sequence[Signals]) -> list[float]:
    """Where the readings end, either way; nowhere if speeds were read."""
    if any(signals.is_speed for signals in recordings):
        return []
    readings = [signals.measured for signals in recordings]
    return [max(float(np.nanmax(r)) for r in readings), min(float(np.nanmin(r)) for r in readings)]


END_STOP = Effect(
    id="end_stop",
    name="end stop",
    equation=(
        "θ ≤ θs (≥ θs where the run began beyond it); a hit turns the speed round: ω → -e·ω; "
        "where it gives by g: τ = -(θ - θs)/g - d·ω beyond it, d the damping that leaves e of the speed"
    ),
    source="Newton's law of restitution; a spring and a damper in parallel, after Kelvin and Voigt, that never pull",
    equation_of="torque_balance",
    shows=("angle", "reversal"),
    parameters=(
        Parameter(
            "limit_deg",
            "limit",
            "deg",
            ANGLE,
            (360.0, -360.0, 90.0, -90.0, 1440.0, -1440.0),
            -36000.0,
            36000.0,
            si=math.pi / 180.0,
            elsewhere={"linear": ("limit_m", "m", 1.0)},
            hints=_reached,
        ),
        Parameter("restitution", "restitution", "1", NUMBER, (0.4,), 0.0, 0.95, spread=1.0, otherwise=0.0),
        Parameter(
            "give_rad_per_nm",
            "give",
            "rad/(N·m)",
            GIVE,
            (0.3, 0.0),
            0.0,
            20.0,
            elsewhere={"linear": ("give_m_per_n", "m/N")},
            otherwise=0.0,
            part_of="give",
        ),
    ),
    terms={"stop": _bounce, "torque": _pushed_back, "damping": _cushioned},
    confusable_with={
        "spring_load": "a push that stalls tells: a spring yields more to a stronger push, a stop does not",
        "gravity_load": "a push that stalls tells: an arm passes over or comes back, a stop only blocks",
    },
)
