"""A push button: a spring under a cap, and a contact that snaps over and back at two heights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray


@final
@dataclass(frozen=True)
class ButtonMechanism:
    """A touch sensor as a mechanism.

    Attributes:
        preload_g: force at which the cap begins to move.
        stiffness_g_per_mm: of the spring.
        over_mm, back_mm: travel at which the contact snaps over and back; equal is no hysteresis.
        rub_g: standard deviation of the cap's friction, another at each turn of the motion.
        creep_g_per_min: by which the preload changes with time.
    """

    preload_g: float = 10.0
    stiffness_g_per_mm: float = 24.0
    over_mm: float = 2.1
    back_mm: float = 2.1
    rub_g: float = 0.3
    creep_g_per_min: float = 0.0


def press_force_g(button: ButtonMechanism) -> float:
    """The force at which the contact snaps over, g."""
    return button.preload_g + button.stiffness_g_per_mm * button.over_mm


def release_force_g(button: ButtonMechanism) -> float:
    """The force at which it snaps back, g."""
    return button.preload_g + button.stiffness_g_per_mm * button.back_mm


def readings(button: ButtonMechanism, time_s: FloatArray, force_g: FloatArray, rng: Generator) -> FloatArray:
    """0 or 1 at each poll, shape (polls,), from an open contact."""
    rising = np.diff(force_g, prepend=force_g[0]) >= 0.0
    turns = np.concatenate(([0], np.cumsum(rising[1:] != rising[:-1])))
    rub = button.rub_g * rng.standard_normal(int(turns[-1]) + 1)
    creep = button.creep_g_per_min * (time_s - time_s[0]) / 60.0
    travel = (force_g - rub[turns] - creep - button.preload_g) / button.stiffness_g_per_mm
    told, closed = np.zeros(force_g.size), False
    for index, depth in enumerate(travel):
        closed = bool(depth > button.back_mm) if closed else bool(depth >= button.over_mm)
        told[index] = closed
    return told
