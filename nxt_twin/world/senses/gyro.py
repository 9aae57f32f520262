"""A rate gyro in a world."""

from __future__ import annotations

import math
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.world.robot import unit_vector
from nxt_twin.world.senses.surroundings import Surroundings
from nxt_twin.world.sensing import GyroMount

_GREATEST_DEG_S: Final = 360.0
"""What HiTechnic's sensor says that it can measure."""


@final
class GyroSense:
    """Readings of a gyro's converter.

    Args:
        mount: what it measures.
        around: the robot that it sits on.
        rng: chance.
    """

    def __init__(self, mount: GyroMount, around: Surroundings, rng: Generator) -> None:
        self._mount, self._around, self._rng = mount, around, rng
        self._axis = np.array(unit_vector(mount.axis))

    def measure(self, time_s: float) -> float:
        """One reading."""
        del time_s
        _, turning = self._around.engine.velocity(self._around.robot)
        rate = math.degrees(float(turning @ (self._around.pose().turn @ self._axis)))
        bounded = min(max(rate, -_GREATEST_DEG_S), _GREATEST_DEG_S)
        noise = float(self._rng.normal(0.0, self._mount.noise_raw))
        return self._mount.rest_raw + self._mount.raw_per_deg_s * bounded + noise
