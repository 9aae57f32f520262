"""The light sensor in a world: what comes back of its lamp from a spot, and what the room sends."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.sensors.light import LightParameters, LightTruth, simulate
from nxt_twin.world.assembly import rotation
from nxt_twin.world.parts import metres
from nxt_twin.world.pose import Pose
from nxt_twin.world.senses.surroundings import Surroundings
from nxt_twin.world.sensing import LightMount

GRADIENT_MM: Final = 297.0
"""The source paper's gradient runs from white to black along an A4 page; a model's slope is by the mm on it."""
_REACH_M: Final = 0.4
_SPOTS: Final = 24
_NEAREST_LAMP_M: Final = 0.05


@final
class LightSense:
    """Readings of a light sensor's converter, with its own lamp or without.

    Args:
        mount: where it sits.
        around: what it looks at.
        rng: chance.
        lit: its lamp is on.
    """

    def __init__(self, mount: LightMount, around: Surroundings, rng: Generator, *, lit: bool) -> None:
        given = LightParameters.from_config(around.model(mount.model if lit else mount.unlit_model))
        room = around.scene.room
        self._parameters = replace(
            given, flicker_amplitude_raw=room.mains_raw, flicker_frequency_hz=room.mains_hz
        )
        self._mount, self._around, self._rng, self._lit = mount, around, rng, lit
        self._face_m = np.array(metres(mount.at_mm))
        self._looking = rotation(mount.turned_rad)[:, 0]
        self._shade_of = {around.things[name]: thing.shade for name, thing in around.scene.things.items()}
        self._spots, self._weights = _footprint()

    def measure(self, time_s: float) -> float:
        """One reading, 0 to 1023."""
        share = self.returned(self._around.pose()) if self._lit else 0.0
        truth = LightTruth(
            np.array([(1.0 - share) * GRADIENT_MM]),
            np.array([time_s]),
            np.array([-self._around.scene.room.light_raw - self._lamps_raw()]),
        )
        return float(simulate(self._parameters, truth, self._rng)[0])

    def returned(self, pose: Pose) -> float:
        """The share of the lamp's light that comes back, 0 to 1: a weighted mean over the spot that it lights."""
        face, looking = pose.point(self._face_m), pose.turn @ self._looking
        hit = self._around.engine.look(face, face + _REACH_M * looking)
        if hit.body < 0:
            return 0.0
        distance_mm = 1e3 * _REACH_M * hit.share
        further = max(distance_mm - self._mount.best_mm, 0.0) / self._mount.fade_mm
        strength = 1.0 / (1.0 + further**2)
        if hit.body != self._around.engine.floor:
            return strength * self._shade_of.get(hit.body, 0.0)
        radius_m = 0.5e-3 * self._mount.spot_mm * max(distance_mm / self._mount.best_mm, 0.5)
        shades = self._around.floor.shade(hit.at_m[:2] + radius_m * self._spots)
        return strength * float(self._weights @ shades)

    def _lamps_raw(self) -> float:
        """What the lamps lower the reading by: each by its distance squared and the angle at which it is seen."""
        if not self._around.scene.lamps:
            return 0.0
        pose = self._around.pose()
        face, looking = pose.point(self._face_m), pose.turn @ self._looking
        total = 0.0
        for lamp in self._around.scene.lamps:
            way = np.array(metres(lamp.at_mm)) - face
            distance_m = max(float(np.linalg.norm(way)), _NEAREST_LAMP_M)
            total += lamp.raw_at_1_m * max(float(way @ looking), 0.0) / distance_m**3
        return total


def _footprint() -> tuple[FloatArray, FloatArray]:
    """Spots evenly over a disc of radius 1, shape (spots, 2), and their weights, most in the middle."""
    n = np.arange(_SPOTS) + 0.5
    radius, turn = np.sqrt(n / _SPOTS), n * np.pi * (3.0 - np.sqrt(5.0))
    weights = np.exp(-1.5 * radius**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)]), weights / weights.sum()
