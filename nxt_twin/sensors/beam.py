"""The ultrasonic sensor's beam: widest at one distance, narrower before and behind it.

The source paper (section III.C) gives 55 degrees at 438 mm, and less on both sides. The lines between are an
assumption.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray


@final
@dataclass(frozen=True)
class Beam:
    """The incidence at which half of the echoes are lost, by distance. Numbers, or arrays that broadcast.

    Attributes:
        max_angle_deg: at the best distance.
        best_distance_mm: where the beam is widest.
        contact_angle_deg: the limit extrapolated to distance 0.
        far_angle_deg: the limit at `far_mm`.
        far_mm: the distance to which `far_angle_deg` belongs.
        near_shape, far_shape: exponents of the fall on either side: 1 is a straight line.
    """

    max_angle_deg: FloatArray | float
    best_distance_mm: FloatArray | float
    contact_angle_deg: FloatArray | float
    far_angle_deg: FloatArray | float
    far_mm: float
    near_shape: float = 1.0
    far_shape: float = 1.0

    def limit_deg(self, distance_mm: FloatArray) -> FloatArray:
        """The limit at each distance."""
        best = self.best_distance_mm
        before = np.maximum(1.0 - distance_mm / best, 0.0) ** self.near_shape
        behind = np.maximum((distance_mm - best) / np.maximum(self.far_mm - best, 1.0), 0.0) ** self.far_shape
        near = (self.contact_angle_deg - self.max_angle_deg) * before
        far = (self.far_angle_deg - self.max_angle_deg) * behind
        return np.asarray(self.max_angle_deg + near + far, dtype=np.float64)
