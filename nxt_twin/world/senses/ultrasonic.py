"""The ultrasonic sensor in a world: rays over its beam, the nearest surface that sends an echo back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.mock.body.ultrasonic import PING_S
from nxt_twin.sensors.ultrasonic import (
    NO_ECHO,
    UltrasonicParameters,
    UltrasonicTruth,
    beam_limit_deg,
    simulate,
    sound_speed,
)
from nxt_twin.world.assembly import rotation
from nxt_twin.world.parts import metres
from nxt_twin.world.senses.surroundings import Surroundings
from nxt_twin.world.sensing import UltrasonicMount

_REACH_M: Final = 2.6
_RINGS: Final = ((0.0, 1), (5.0, 6), (10.0, 8), (16.0, 8), (24.0, 8), (33.0, 8), (43.0, 8), (54.0, 8))
"""Angles off the axis (deg), and how many rays there are on each."""
_NOWHERE_MM: Final = 1e4
_NEVER_DEG: Final = 179.0


@final
class UltrasonicSense:
    """Readings of an ultrasonic sensor, cm; the mock's `SensorView`, asked at each ping.

    A surface sends an echo if its incidence plus the ray's angle off the axis is within the model's beam. For
    a flat wall this sum is the wall's own angle, which the source paper measured. The echo that counts is the
    nearest.

    Args:
        mount: where it sits.
        around: what it looks at.
        rng: chance.
        others_ping: whether another sensor's pings are in the air.

    Attributes:
        ray_m: from where to where the last echo's ray went, shape (2, 3); None without an echo.
    """

    def __init__(
        self, mount: UltrasonicMount, around: Surroundings, rng: Generator, others_ping: Callable[[], bool]
    ) -> None:
        given = UltrasonicParameters.from_config(around.model(mount.model))
        # Time between pings is the mock's own.
        self._parameters = replace(given, air_temperature_c=around.scene.room.air_c, update_period_s=0.0)
        way_mm = 0.5e3 * sound_speed(around.scene.room.air_c) * PING_S
        self._disturbed = replace(self._parameters, crosstalk_per_mm=1.0 / way_mm)
        self._around, self._rng, self._others_ping = around, rng, others_ping
        self._face_m = np.array(metres(mount.at_mm))
        self.ray_m: FloatArray | None = None
        inside, self._off_deg = _beam()
        self._rays = inside @ rotation(mount.turned_rad).T

    def at(self, time_s: float) -> float:
        """The reading at a time, cm; 255 without an echo."""
        del time_s
        distance_mm, angle_deg = self.nearest()
        truth = UltrasonicTruth(np.array([distance_mm]), np.array([angle_deg]))
        parameters = self._disturbed if self._others_ping() else self._parameters
        reading = float(simulate(parameters, truth, self._rng)[0])
        return min(reading, NO_ECHO)

    def nearest(self) -> tuple[float, float]:
        """Distance (mm) and angle (deg) of the nearest surface that can be heard; far away and edge-on if none can."""
        pose = self._around.pose()
        start = pose.point(self._face_m)
        rays = self._rays @ pose.turn.T
        hits = self._around.engine.cast(np.broadcast_to(start, rays.shape), start + _REACH_M * rays)
        distance_mm = 1e3 * _REACH_M * hits.share
        cosine = np.clip(-np.sum(rays * hits.normal, axis=1), -1.0, 1.0)
        angle_deg = np.degrees(np.arccos(cosine)) + self._off_deg
        limit_deg = beam_limit_deg(self._parameters, distance_mm) + 2.0 * self._parameters.beam_edge_deg
        heard = np.flatnonzero((hits.body >= 0) & (angle_deg <= limit_deg))
        self.ray_m = None
        if not heard.size:
            return _NOWHERE_MM, _NEVER_DEG
        first = heard[np.argmin(distance_mm[heard])]
        self.ray_m = np.array([start, hits.at_m[first]])
        return float(distance_mm[first]), float(angle_deg[first])


def _beam() -> tuple[FloatArray, FloatArray]:
    """Unit vectors of rays round the x axis, shape (rays, 3), and their angles off it, deg."""
    off, around = [], []
    for angle, count in _RINGS:
        off += [angle] * count
        around += [360.0 * (n + 0.5 * (angle % 2)) / count for n in range(count)]
    a, b = np.radians(off), np.radians(around)
    return np.column_stack([np.cos(a), np.sin(a) * np.cos(b), np.sin(a) * np.sin(b)]), np.array(off)
