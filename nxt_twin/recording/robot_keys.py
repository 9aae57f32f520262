"""The keys that only a robot's mapping has. Each sidecar is asked for them; the models are slow to build."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

ROBOT_KEYS: Final = (
    "pose_x", "pose_y", "pose_heading", "left_angle", "right_angle", "left_power", "right_power",
)  # fmt: skip
"""The keys of pose, wheels and powers."""


def is_robots(keys: Mapping[str, Any]) -> bool:
    """Whether keys are those of a robot's mapping."""
    return not keys.keys().isdisjoint(ROBOT_KEYS)
