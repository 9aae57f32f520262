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

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.smooth import half_window_s
from nxt_twin.physics.start import Start

_SLOPE_STD = 2.0  # of a speed read off a few readings, in reading deviations over the smoother's half window


@final
@dataclass(frozen=True)
class Noise:
    """The noise of a recording.

    Attributes:
        reading_std: of the readings, rad or m (or per second), quantisation included.
        disturbance_std: of the unknown torque over inertia, rad/s² or m/s².
        disturbance_time_s: how long it takes to forget.
        damping_per_s: how fast the plant itself forgets its speed.
        drift: how many times further off simulated readings are than these make them: a model's systematic error.
        slip: variance that a position gains by itself for each unit that it moves, rad or m: counts lost at random.
    """

    reading_std: float
    disturbance_std: float
    disturbance_time_s: float
    damping_per_s: float
    drift: float = 1.0
    slip: float = 0.0


@final
@dataclass(frozen=True)
class Observer:
    """Gains, shape (samples, 3), and the standard deviation of each innovation, shape (samples,)."""

    gains: FloatArray
    innovation_std: FloatArray


def observer(signals: Signals, noise: Noise, corrected: BoolArray | None = None) -> Observer:
    """The optimal gains for `signals` under `noise`; a reading that is missing or not `corrected` has none."""
    known = np.isfinite(signals.measured)
    if corrected is not None:
        known &= corrected
    return _observe(signals, noise, known, np.zeros(known.size, dtype=bool))


def free_run_std(signals: Signals, noise: Noise, start: Start) -> FloatArray:
    """How far off each reading of a run that nothing corrects between starts is under `noise`, shape (samples,)."""
    return _observe(signals, noise, np.zeros(signals.time_s.size, dtype=bool), start.at).innovation_std


def free(signals: Signals, reading_std: float) -> Observer:
    """No correction at all: a free run."""
    rows = signals.time_s.size
    return Observer(np.zeros((rows, 3)), np.full(rows, reading_std))


def _observe(signals: Signals, noise: Noise, known: BoolArray, reset: BoolArray) -> Observer:
    rows = signals.time_s.size
    gains, std = np.zeros((rows, 3)), np.zeros(rows)
    start_speed_std = _SLOPE_STD * noise.reading_std / half_window_s(signals)
    variances = np.array([noise.reading_std, start_speed_std, noise.disturbance_std]) ** 2
    rates_per_s = (noise.damping_per_s, 1.0 / noise.disturbance_time_s)
    slipped = slips(signals, noise)
    strayed = signals.strays**2
    _riccati(
        signals.time_s, known, reset, variances, rates_per_s, signals.is_speed, slipped, strayed, gains, std
    )
    return Observer(gains, std)


def slips(signals: Signals, noise: Noise) -> FloatArray:
    """The variance that a position gains by itself since the sample before, SI, shape (samples,)."""
    if signals.is_speed or not noise.slip:
        return np.zeros(signals.time_s.size)
    read = np.isfinite(signals.measured)
    rows = np.arange(read.size)
    course = np.interp(rows, rows[read], signals.measured[read]) if read.any() else np.zeros(read.size)
    return noise.slip * np.abs(np.diff(course, prepend=course[0]))


@njit(cache=True, nogil=True)
def carried(covariance, dt_s, damping_per_s, leak_per_s, torque_var):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """The covariance after `dt_s` without a reading; compiled.

    A covariance is six numbers, the upper triangle row by row: angle with angle, speed and torque; speed with speed
    and torque; torque with torque. `torque_var` is the stationary variance of the torque over inertia. Written out
    element by element: the same with matrices takes ten times as long.
    """
    aa, av, ad, vv, vd, dd = covariance
    hold = math.exp(-damping_per_s * dt_s)
    forget = math.exp(-leak_per_s * dt_s)
    gain = (1.0 - hold) / damping_per_s if damping_per_s > 1e-9 else dt_s
    half = 0.5 * dt_s * dt_s
    fresh = torque_var * (1.0 - forget * forget)
    to_angle = aa + gain * av + half * ad
    to_speed = av + gain * vv + half * vd
    to_push = ad + gain * vd + half * dd
    held_speed = hold * vv + gain * vd
    held_push = hold * vd + gain * dd
    return (
        to_angle + gain * to_speed + half * to_push,
        hold * to_speed + gain * to_push,
        forget * to_push,
        hold * held_speed + gain * held_push + fresh * dt_s * dt_s / 3.0,
        forget * held_push + 0.5 * fresh * dt_s,
        forget * forget * dd + fresh,
    )


@njit(cache=True, nogil=True)
def corrected(covariance, reads_speed, reading_var):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """The covariance after a reading, its three gains, and the variance of the innovation; compiled."""
    aa, av, ad, vv, vd, dd = covariance
    seen_angle, seen_speed, seen_push = (av, vv, vd) if reads_speed else (aa, av, ad)
    variance = (vv if reads_speed else aa) + reading_var
    to_angle, to_speed, to_push = seen_angle / variance, seen_speed / variance, seen_push / variance
    left = (
        aa - to_angle * seen_angle,
        av - to_angle * seen_speed,
        ad - to_angle * seen_push,
        vv - to_speed * seen_speed,
        vd - to_speed * seen_push,
        dd - to_push * seen_push,
    )
    return left, (to_angle, to_speed, to_push), variance


@njit(cache=True, nogil=True)
def _riccati(  # type: ignore[no-untyped-def]  # noqa: ANN202  # compiled: numba infers the types
    time_s,  # noqa: ANN001
    known,  # noqa: ANN001
    reset,  # noqa: ANN001
    variances,  # noqa: ANN001
    rates_per_s,  # noqa: ANN001
    reads_speed,  # noqa: ANN001
    slipped,  # noqa: ANN001
    strayed,  # noqa: ANN001
    gains,  # noqa: ANN001
    std,  # noqa: ANN001
):
    damping_per_s, leak_per_s = rates_per_s
    reading_var, speed_var, torque_var = variances
    first = (reading_var, 0.0, 0.0, speed_var, 0.0, torque_var)
    covariance = first
    std[0] = math.sqrt(reading_var)
    for k in range(1, time_s.shape[0]):
        aa, av, ad, vv, vd, dd = carried(
            covariance, time_s[k] - time_s[k - 1], damping_per_s, leak_per_s, torque_var
        )
        covariance = (aa + slipped[k], av, ad, vv, vd, dd)
        if reset[k]:
            covariance = first
        left, gain, variance = corrected(covariance, reads_speed, reading_var + strayed[k])
        std[k] = math.sqrt(variance)
        if not known[k]:
            continue
        covariance = left
        gains[k, 0], gains[k, 1], gains[k, 2] = gain
