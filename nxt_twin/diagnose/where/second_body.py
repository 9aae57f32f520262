"""The reaction of a second body that a motion drags along: on a spring, behind play, or held by rubbing.

The motion is given, so each is a simple sum. All return the body's pull per unit of its inertia, 1/s² times
the motion's unit, shape (samples,).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from nxt_twin.arrays import FloatArray

_STEPS_PER_RADIAN = 4.0  # steps of integration while a body on a spring goes through a radian of its phase
_RUBBING_STEP_S = 2e-3  # s: longest step of integration of a body that rubs


def on_a_spring(
    time_s: FloatArray, position: FloatArray, frequency_hz: float, damping_ratio: float
) -> tuple[FloatArray, FloatArray]:
    """Pull of a spring and of a damper beside it, on a body at y: `y'' = ω²·(x - y) + 2·ζ·ω·(x' - y')`."""
    spring, damper = np.zeros(position.size), np.zeros(position.size)
    _spring(time_s, position, 2.0 * math.pi * frequency_hz, damping_ratio, spring, damper)
    return spring, damper


def behind_play(
    time_s: FloatArray, position: FloatArray, speed: FloatArray, gap: float, drag_per_s: float, rebound: float
) -> FloatArray:
    """Blows of a body that runs freely within `gap` and leaves a blow with `rebound` of the speed it met with."""
    found = np.zeros(position.size)
    _play(time_s, position, speed, gap, drag_per_s, rebound, found)
    return found


def by_rubbing(time_s: FloatArray, speed: FloatArray, grip: float) -> FloatArray:
    """Pull of a body that dry friction takes along, at most `grip` (1/s² times the motion's unit)."""
    found = np.zeros(speed.size)
    _rubbing(time_s, speed, grip, found)
    return found


@njit(cache=True, nogil=True)
def _spring(time_s, position, omega, damping_ratio, spring, damper):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    """The mean pull of each interval, in which the motion is taken as even."""
    at, pace = position[0], 0.0
    for k in range(1, time_s.shape[0]):
        dt = time_s[k] - time_s[k - 1]
        steps = max(1, math.ceil(dt * omega * _STEPS_PER_RADIAN))
        given = (position[k] - position[k - 1]) / dt
        for i in range(steps):
            stretch = position[k - 1] + given * dt * (i + 0.5) / steps - at - 0.5 * pace * dt / steps
            stretching = given - pace
            spring[k] -= omega * omega * stretch / steps
            damper[k] -= omega * stretching / steps
            pace += dt / steps * (omega * omega * stretch + 2.0 * damping_ratio * omega * stretching)
            at += dt / steps * pace


@njit(cache=True, nogil=True)
def _play(time_s, position, speed, gap, drag_per_s, rebound, found):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    at, pace = position[0], 0.0
    for k in range(1, time_s.shape[0]):
        dt = time_s[k] - time_s[k - 1]
        pace *= math.exp(-drag_per_s * dt)
        at += pace * dt
        free = pace
        side = 1.0 if at > position[k] else -1.0
        if side * (at - position[k]) > 0.5 * gap:
            at = position[k] + 0.5 * side * gap
            if side * (pace - speed[k]) > 0.0:
                pace = speed[k] - rebound * (pace - speed[k])
        found[k] = (free - pace) / dt


@njit(cache=True, nogil=True)
def _rubbing(time_s, speed, grip, found):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    pace = 0.0
    for k in range(1, time_s.shape[0]):
        dt = time_s[k] - time_s[k - 1]
        steps = max(1, math.ceil(dt / _RUBBING_STEP_S))
        before = pace
        for i in range(steps):
            target = speed[k - 1] + (speed[k] - speed[k - 1]) * (i + 1) / steps
            most = grip * dt / steps
            pace += min(max(target - pace, -most), most)
        found[k] = (before - pace) / dt
