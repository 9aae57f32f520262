"""The sound sensor in a world: the sources' powers by distance, over the room's own noise."""

from __future__ import annotations

from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.sensors.sound import SoundParameters, SoundTruth, simulate
from nxt_twin.world.parts import metres
from nxt_twin.world.senses.surroundings import Surroundings
from nxt_twin.world.sensing import SoundMount

_NEAREST_M = 0.02


@final
class SoundSense:
    """Readings of a sound sensor's converter. It hears the loudest source's tone.

    Args:
        mount: where it sits.
        around: what it hears.
        rng: chance.
    """

    def __init__(self, mount: SoundMount, around: Surroundings, rng: Generator) -> None:
        self._parameters = SoundParameters.from_config(around.model(mount.model))
        self._around, self._rng = around, rng
        self._face_m = np.array(metres(mount.at_mm))

    def measure(self, time_s: float) -> float:
        """One reading, 0 to 1023."""
        level_db, hz = self.heard(time_s)
        return float(
            simulate(self._parameters, SoundTruth(np.array([level_db]), np.array([hz])), self._rng)[0]
        )

    def heard(self, time_s: float) -> tuple[float, float]:
        """The level at the sensor (dB) and its tone (Hz)."""
        noise_db = self._around.scene.room.noise_db
        if not self._around.scene.sounds:
            return noise_db, 1000.0
        face = self._around.pose().point(self._face_m)
        power, loudest, hz = 10.0 ** (0.1 * noise_db), 0.0, 1000.0
        for source in self._around.scene.sounds:
            if source.during_s is not None and not source.during_s[0] <= time_s < source.during_s[1]:
                continue
            distance_m = max(float(np.linalg.norm(metres(source.at_mm) - face)), _NEAREST_M)
            own = 10.0 ** (0.1 * source.db_at_1_m) / distance_m**2
            power += own
            if own > loudest:
                loudest, hz = own, source.hz
        return 10.0 * float(np.log10(power)), hz
