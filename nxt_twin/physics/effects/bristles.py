"""Bristles that bend before they slide, in the place of sticking (Dahl 1968)."""

from __future__ import annotations

import math

from nxt_twin.physics.inline import exponential


def bristle_torque(
    level: float, direction: float, speed: float, bend: float, reach: float, step_s: float
) -> tuple[float, float]:
    """The bristles' torque at rest, and its growth with the step's mean speed by half a step's bend."""
    heading = math.copysign(1.0, speed) if speed != 0.0 else direction
    return level * bend, 0.5 * step_s * level / reach * (1.0 - bend * heading)


def bent(bend: float, before: float, after: float, reach: float, step_s: float) -> float:
    """How far they are bent after a step, as a share of what they bear."""
    moved = 0.5 * (before + after) * step_s
    left = exponential(-abs(moved) / reach)
    return bend * left + math.copysign(1.0 - left, moved)
