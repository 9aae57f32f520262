"""The gains with which a prediction-error run corrects the plant's state at each reading.

A Kalman filter for angle, speed and an unknown torque in units of acceleration: ω' = -β·ω + d, d a leaky random
walk (Ornstein-Uhlenbeck). The leak matters: a random walk without one swallows every slow missing torque.
The gains depend on stamps and noise alone, so they are worked out once and hold for every candidate model.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np
from numba import njit

from nxt_twin.physics.signals import Signals
from nxt_twin.recording.recording import FloatArray


@final
@dataclass(frozen=True)
class Noise:
    """What is random in a recording.

    Attributes:
        reading_std: of the readings, rad or m (or per second), quantisation included.
        disturbance_std: of the unknown torque over inertia, rad/s² or m/s².
        disturbance_time_s: how long it takes to forget.
        damping_per_s: how fast the plant itself forgets its speed.
    """

    reading_std: float
    disturbance_std: float
    disturbance_time_s: float
    damping_per_s: float


@final
@dataclass(frozen=True)
class Observer:
    """Gains, shape (samples, 3), and the standard deviation of each innovation, shape (samples,)."""

    gains: FloatArray
    innovation_std: FloatArray


def observer(signals: Signals, noise: Noise) -> Observer:
    """The optimal gains for `signals` under `noise`; a reading that is missing has none."""
    rows = signals.time_s.size
    gains = np.zeros((rows, 3))
    std = np.zeros(rows)
    _riccati(
        signals.time_s,
        np.isfinite(signals.measured),
        noise.reading_std**2,
        noise.disturbance_std**2,
        1.0 / noise.disturbance_time_s,
        noise.damping_per_s,
        signals.is_speed,
        gains,
        std,
    )
    return Observer(gains, std)


def free(signals: Signals, reading_std: float) -> Observer:
    """No correction at all: a free run."""
    rows = signals.time_s.size
    return Observer(np.zeros((rows, 3)), np.full(rows, reading_std))


@njit(cache=True, nogil=True)
def _riccati(  # type: ignore[no-untyped-def]  # compiled: numba infers the types
    time_s, known, reading_var, disturbance_var, leak_per_s, damping_per_s, is_speed, gains, std
):
    covariance = np.zeros((3, 3))
    covariance[0, 0] = reading_var
    covariance[1, 1] = 1e-6 * disturbance_var
    covariance[2, 2] = disturbance_var
    transition = np.eye(3)
    h = 1 if is_speed else 0
    for k in range(1, time_s.shape[0]):
        dt = time_s[k] - time_s[k - 1]
        hold = math.exp(-damping_per_s * dt)
        forget = math.exp(-leak_per_s * dt)
        gain = (1.0 - hold) / damping_per_s if damping_per_s > 1e-9 else dt
        transition[0, 1] = gain
        transition[0, 2] = 0.5 * dt * dt
        transition[1, 1] = hold
        transition[1, 2] = gain
        transition[2, 2] = forget
        covariance = transition @ covariance @ transition.T
        fresh = disturbance_var * (1.0 - forget * forget)
        covariance[2, 2] += fresh
        covariance[1, 1] += fresh * dt * dt / 3.0
        covariance[1, 2] += 0.5 * fresh * dt
        covariance[2, 1] += 0.5 * fresh * dt
        variance = covariance[h, h] + reading_var
        std[k] = math.sqrt(variance)
        if not known[k]:
            continue
        for i in range(3):
            gains[k, i] = covariance[i, h] / variance
        row = covariance[h].copy()
        for i in range(3):
            for m in range(3):
                covariance[i, m] -= gains[k, i] * row[m]
