"""Which parameters of a geometry some paths can tell at all."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Final

import numpy as np

from nxt_twin.arrays import BoolArray
from nxt_twin.diagnose.robot.runs import RobotRun
from nxt_twin.diagnose.robot.windows import PARAMETERS

_NEED_TRAVEL: Final = ("mean_wheel_radius_m", "wheel_radius_ratio", "heading_offset_deg")
"""On the spot, only the ratio of radius to track shows, and unequal wheels look like a marker aside."""

_WINDOW_S: Final = 1.0  # length of the windows in which a robot travels or turns on the spot
_TRAVELS: Final = 0.25
"""The robot travels in a window where the mean of both wheels' angles is such a share of what they turn."""
_LEAST_TRAVEL_RAD: Final = pi


def tellable(runs: Sequence[RobotRun]) -> BoolArray:
    """Which of `PARAMETERS` these paths can tell, shape (6,); turning on the spot tells but a few."""
    travels = sum(_travelled_rad(run) for run in runs) >= _LEAST_TRAVEL_RAD
    return np.array([travels or name not in _NEED_TRAVEL for name in PARAMETERS])


def _travelled_rad(run: RobotRun) -> float:
    """The mean angle of both wheels, summed over the windows in which the robot travels."""
    edges = np.searchsorted(run.time_s, np.arange(run.time_s[0], run.time_s[-1] + _WINDOW_S, _WINDOW_S))
    rows = np.unique(np.minimum(edges, run.time_s.size - 1))
    left, right = np.diff(run.left_rad[rows]), np.diff(run.right_rad[rows])
    middle, turned = 0.5 * np.abs(left + right), 0.5 * (np.abs(left) + np.abs(right))
    return float(np.sum(middle[middle > _TRAVELS * turned]))
