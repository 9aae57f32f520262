"""Effects of a servo's loop beyond proportion and damping."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from nxt_twin.physics.effect import Effect
from nxt_twin.physics.parameter import NUMBER, Parameter

if TYPE_CHECKING:
    from nxt_twin.physics.signals import Signals

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


def _clipped(duty: float, most: float) -> float:
    return min(max(duty, -most), most)


POWER_LIMIT = Effect(
    id="power_limit",
    name="power limit of the loop",
    equation="|u| ≤ umax, below the limit that the plant states",
    source="the PWM limit or maximum torque of a servo's register table",
    equation_of="electrical",
    shows=("after_command", "high_speed"),
    neutral=100.0,
    notable=5.0,
    parameters=(Parameter("limit_pct", "most", "%", NUMBER, (60.0, 35.0, 80.0), 2.0, 100.0, si=0.01),),
    terms={"duty": _clipped},
    confusable_with={
        "current_limit": "a long way tells: a limit of the duty bounds the speed, one of the current only its growth",
        "goal_rate_limit": "a load tells: the speed under a limit of the duty falls with it, a ramp's does not",
    },
    frames=("motor",),
    kinds=_SERVO,
)


def _outside(goal: float, angle: float, width: float) -> float:
    """Within the band the loop follows where it is: its error counts as none."""
    return goal if abs(goal - angle) > width else angle


def _step(recordings: Sequence[Signals]) -> float:
    """The coarsest step of a reading: an error within it moves no loop that counts."""
    return max(signals.quantum for signals in recordings)


LOOP_DEAD_BAND = Effect(
    id="loop_dead_band",
    name="loop dead band",
    equation="e = 0 while |θg - θ| ≤ w, w above the band that the plant states",
    source="the dead zone of a servo's register table",
    equation_of="timing",
    shows=("low_speed", "after_command"),
    parameters=(
        Parameter(
            "width_deg", "width", "deg", NUMBER, (1.0, 0.4, 3.0), 0.0, 90.0, si=math.pi / 180.0, least=_step
        ),
    ),
    terms={"goal": _outside},
    confusable_with={
        "coulomb_friction": "a goal that creeps tells: with a dead band each jump ends where the error leaves the band",
        "backlash": "a hand tells: play gives way to it at once, a loop pushes back from the band's edge on",
    },
    frames=("motor",),
    kinds=_SERVO,
)
