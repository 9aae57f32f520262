"""A photodiode over a printed gradient: lamp, paper, room, mains, amplifier, converter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray

_FULL_SCALE = 1023.0


@final
@dataclass(frozen=True)
class Photodiode:
    """A light sensor as a mechanism; raw counts fall as more light comes in.

    Attributes:
        dark_raw: counts without any light.
        white_raw, black_raw: by which the lamp's light from white and from black paper pulls them down.
        length_mm: of the gradient from white to black.
        room_raw: by which the room pulls them down further.
        mains_hz: of the mains; the room's lamps swing at twice that.
        swing_raw: amplitude of that swing.
        ceiling_raw: the amplifier leaves its straight part at this many counts below dark; None: never.
        headroom_raw: by which it still goes on.
        noise_raw: standard deviation.
        wave_raw: by which the printer's grey goes above and then below the straight line.
    """

    dark_raw: float = 900.0
    white_raw: float = 500.0
    black_raw: float = 120.0
    length_mm: float = 280.0
    room_raw: float = 0.0
    mains_hz: float = 50.0
    swing_raw: float = 0.0
    ceiling_raw: float | None = None
    headroom_raw: float = 12.0
    noise_raw: float = 2.5
    wave_raw: float = 0.0


def readings_raw(
    sensor: Photodiode, time_s: FloatArray, position_mm: FloatArray, phase_rad: float, rng: Generator
) -> FloatArray:
    """Counts 0 to 1023 at each poll, shape (polls,)."""
    place = position_mm / sensor.length_mm
    reflected = sensor.white_raw * (1.0 - place) + sensor.black_raw * place
    reflected = reflected + sensor.wave_raw * np.sin(2.0 * np.pi * place)
    mains = np.cos(2.0 * np.pi * sensor.mains_hz * time_s + phase_rad)
    light = reflected + sensor.room_raw + sensor.swing_raw * (2.0 * mains**2 - 1.0)
    if sensor.ceiling_raw is not None:
        over = np.maximum(light - sensor.ceiling_raw, 0.0)
        light = light - over + sensor.headroom_raw * np.tanh(over / sensor.headroom_raw)
    counts = sensor.dark_raw - light + sensor.noise_raw * rng.standard_normal(time_s.size)
    return np.clip(np.floor(counts + 0.5), 0.0, _FULL_SCALE)
