"""The sizes in which effects are hidden, and the equations that they change."""

from __future__ import annotations

from typing import Final, Literal

Size = Literal["small", "medium", "large"]
SIZES: Final[tuple[Size, ...]] = ("small", "medium", "large")

Equation = Literal["torque_balance", "electrical", "kinematic", "measurement", "timing"]
"""What makes the torque, the current, the joint of two bodies, the reading of an angle, or the stamps."""
