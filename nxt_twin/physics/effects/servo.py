"""Effects of a servo's loop beyond proportion and damping."""

from __future__ import annotations

import math

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import NUMBER, Parameter

_SERVO = ("servo",)


def _reached_for(goal: float, ramp: float, step_s: float, rate_limit: float) -> float:
    """The goal of the step's middle, which moves no faster than the limit."""
    most = 0.5 * rate_limit * step_s
    return ramp + min(max(goal - ramp, -most), most)


def _ramped(ramp: float, held: float, step_s: float, rate_limit: float) -> float:
    most = rate_limit * step_s
    return ramp + min(max(held - ramp, -most), most)


GOAL_RATE_LIMIT = Effect(
    id="goal_rate_limit",
    name="goal rate limit",
    equation="|dθg/dt| ≤ r, θg from the angle at which the run began",
    source="the profile velocity of a servo's register table",
    equation_of="timing",
    shows=("after_command",),
    parameters=(
        Parameter(
            "goal_rate_limit_deg_per_s",
            "rate_limit",
            "deg/s",
            NUMBER,
            (180.0, 60.0, 400.0),
            1.0,
            1e5,
            si=math.pi / 180.0,
        ),
    ),
    terms={"goal": _reached_for, "advance": _ramped},
    states=("ramp",),
    placed=("ramp",),
    confusable_with={
        "command_delay": "goals that leap by several sizes tell: a delay is as long for each, a ramp is not",
    },
    frames=("motor",),
    kinds=_SERVO,
    plain=True,
)


def _shifted(goal: float, error_sum: float, integral_rate: float) -> float:
    return goal + integral_rate * error_sum


def _summed(error_sum: float, held: float, angle: float, duty: float, step_s: float) -> float:
    """A loop whose duty is at its full scale sums no further."""
    return error_sum + (step_s * (held - angle) if abs(duty) < 0.999 else 0.0)


INTEGRAL_ACTION = Effect(
    id="integral_action",
    name="integral action of the loop",
    equation="u = Kp·(e + ki·∫e dt)",
    source="the proportional-integral controller; it stops summing at full duty",
    equation_of="timing",
    shows=("low_speed", "angle"),
    parameters=(
        Parameter("integral_rate_per_s", "integral_rate", "1/s", NUMBER, (1.0, 0.2, 5.0), 0.0, 200.0),
    ),
    terms={"goal": _shifted, "advance": _summed},
    states=("error_sum",),
    confusable_with={
        "coulomb_friction": "a goal that is held tells: friction leaves an error standing, an integral wears it away",
    },
    frames=("motor",),
    kinds=_SERVO,
    plain=True,
)
