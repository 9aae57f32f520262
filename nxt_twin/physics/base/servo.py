"""A motor that a loop of the device itself brings to a goal: Dynamixel, Feetech, hobby servos, a regulated NXT motor.

The motor is a `dc_motor`. A proportional-derivative loop on the angle commands its duty, up to a limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from nxt_twin.physics.base.base import Base
from nxt_twin.physics.base.dc_motor import DC_MOTOR
from nxt_twin.physics.parameter import NUMBER, Parameter

if TYPE_CHECKING:
    from nxt_twin.physics.signals import Signals

_PCT_PER_DEG = 0.01 * 180.0 / math.pi
"""Duty (-1…1) per rad of one percent per degree."""


def control(
    goal: float,
    angle: float,
    speed: float,
    position_gain: float,
    derivative_gain: float,
    power_limit: float,
    dead_band: float,
    goal_offset: float,
) -> float:
    """The duty (-1…1) that the loop commands.

    Within the dead band the error counts as none. The derivative is that of the angle, not of the goal, so that a
    goal that leaps gives no kick. The loop stands still where readings show the goal and the offset.
    """
    error = goal + goal_offset - angle
    duty = position_gain * error if abs(error) > dead_band else 0.0
    duty -= derivative_gain * speed
    return min(max(duty, -power_limit), power_limit)


def _half_a_step(recordings: Sequence[Signals]) -> float:
    """What nobody knows of an encoder: whether its readings are rounded, up or down (rad)."""
    return 0.5 * max((signals.quantum for signals in recordings), default=0.0)


SERVO = Base(
    kind="servo",
    frames=("motor",),
    parameters=(
        *DC_MOTOR.parameters,
        Parameter(
            "position_gain_pct_per_deg",
            "position_gain",
            "%/deg",
            NUMBER,
            (0.3,),
            1e-4,
            100.0,
            doubt=0.3,
            si=_PCT_PER_DEG,
        ),
        Parameter(
            "derivative_gain_pct_s_per_deg",
            "derivative_gain",
            "%·s/deg",
            NUMBER,
            (0.01,),
            0.0,
            10.0,
            doubt=0.5,
            si=_PCT_PER_DEG,
            otherwise=0.0,
        ),
        Parameter(
            "power_limit_pct",
            "power_limit",
            "%",
            NUMBER,
            (100.0,),
            0.0,
            100.0,
            si=0.01,
            frozen=True,
            otherwise=100.0,
        ),
        Parameter(
            "dead_band_deg",
            "dead_band",
            "deg",
            NUMBER,
            (0.5,),
            0.0,
            90.0,
            si=math.pi / 180.0,
            frozen=True,
            otherwise=0.0,
        ),
        Parameter("goal_delay_s", "goal_delay", "s", NUMBER, (0.01,), 0.0, 1.0, frozen=True, otherwise=0.0),
        Parameter(
            "goal_offset_deg",
            "goal_offset",
            "deg",
            NUMBER,
            (0.0,),
            -90.0,
            90.0,
            doubt=0.5,
            si=math.pi / 180.0,
            otherwise=0.0,
            least=_half_a_step,
        ),
    ),
    drive=DC_MOTOR.drive,
    current_after=DC_MOTOR.current_after,
    drawn_by_others=DC_MOTOR.drawn_by_others,
    control=control,
    delay="goal_delay",
)
