"""The linear observer by itself: deviations from innovations, their likelihood, and synthetic clean recordings.

The state is position, speed and an unknown torque over inertia that leaks away, as in `physics.observer`.
Here the noise may change from reading to reading.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np
from numba import njit
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.machine_code import forget_outdated
from nxt_twin.physics import observer
from nxt_twin.physics.observer import Noise, carried, corrected, slips
from nxt_twin.physics.simulate import Job

_STANDING_SHARE = 1e-3  # of the largest step between readings, below which a predicted motor stands
_VAGUE_SPEED = 1e2  # variance of the first speed per second squared, over that of a reading


@final
@dataclass(frozen=True)
class Randomness:
    """Variances at each sample of a job, SI, each of shape (samples,).

    Attributes:
        reading: of the reading.
        torque: of the unknown torque over inertia, stationary.
        slip_per_s: that the position gains by itself in a second.
    """

    reading: FloatArray
    torque: FloatArray
    slip_per_s: FloatArray


def quiet(job: Job, noise: Noise) -> Randomness:
    """The same noise at every sample, but for readings whose moment is open."""
    ones = np.ones(job.signals.time_s.size)
    since_s = np.maximum(np.diff(job.signals.time_s, prepend=-np.inf), 1e-9)
    return Randomness(
        noise.reading_std**2 + job.signals.strays**2,
        noise.disturbance_std**2 * ones,
        slips(job.signals, noise) / since_s,
    )


def deviation(job: Job, predicted: FloatArray, noise: Noise) -> FloatArray:
    """How far readings are from what the plant would have done without correction, to first order, SI.

    Args:
        job: the recording, with the gains under which it was run.
        predicted: each reading as predicted by the corrected run, SI, shape (samples,).
        noise: its damping and its memory.
    """
    signals = job.signals
    known = np.isfinite(signals.measured) & ~job.start.at
    innovation = np.where(known, signals.measured - predicted, 0.0)
    found = np.zeros(known.size)
    _undo(
        signals.time_s,
        innovation,
        job.observer.gains,
        noise.damping_per_s,
        1.0 / noise.disturbance_time_s,
        1 if signals.is_speed else 0,
        found,
    )
    return np.asarray(np.where(known, found, np.nan))


def cost(job: Job, deviations: FloatArray, noise: Noise, randomness: Randomness) -> float:
    """Negative log-likelihood of `deviations` under `randomness`, nats."""
    signals = job.signals
    return float(
        _cost(
            signals.time_s,
            deviations,
            noise.damping_per_s,
            1.0 / noise.disturbance_time_s,
            1 if signals.is_speed else 0,
            randomness.reading,
            randomness.torque,
            randomness.slip_per_s,
        )
    )


def clean_innovations(
    job: Job, predicted: FloatArray, noise: Noise, count: int, rng: Generator
) -> FloatArray:
    """Innovations of `count` recordings like `job` in which nothing is missing, over their standard deviations.

    They share the stamps, gains, unknown torque, reading noise and quantum of `job`. Where the plant stands,
    dry friction holds it against the unknown torque.

    Returns:
        Shape (count, samples); 0 where there is no reading.
    """
    signals = job.signals
    known = np.isfinite(signals.measured) & ~job.start.at
    step = np.abs(np.diff(predicted, prepend=predicted[0]))
    standing = step < _STANDING_SHARE * max(float(np.max(step)), 1e-12)
    quantum = 0.0 if signals.is_speed else signals.quantum
    own_std = np.sqrt(max(noise.reading_std**2 - quantum**2 / 12.0, 0.0) + signals.strays**2)
    found = np.zeros((count, known.size))
    foretold = np.nan_to_num(predicted)
    slipping = np.sqrt(slips(signals, noise))
    for row in found:  # by itself, since its random numbers take more room than what is made of them
        _clean(
            signals.time_s,
            foretold,
            known,
            standing,
            job.observer.gains,
            job.observer.innovation_std,
            noise.damping_per_s,
            1.0 / noise.disturbance_time_s,
            1 if signals.is_speed else 0,
            quantum,
            own_std,
            noise.disturbance_std,
            slipping * rng.standard_normal(known.size) if slipping.any() else slipping,
            rng.standard_normal((known.size, 2)),
            row,
        )
    return found


@njit(cache=True, nogil=True)
def _propagate(state, dt, damping_per_s, leak_per_s):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
    hold = math.exp(-damping_per_s * dt)
    gain = (1.0 - hold) / damping_per_s if damping_per_s > 1e-9 else dt
    state[0] += gain * state[1] + 0.5 * dt * dt * state[2]
    state[1] = hold * state[1] + gain * state[2]
    state[2] *= math.exp(-leak_per_s * dt)


@njit(cache=True, nogil=True)
def _undo(  # type: ignore[no-untyped-def]  # noqa: ANN202  # compiled: numba infers the types
    time_s,  # noqa: ANN001
    innovation,  # noqa: ANN001
    gains,  # noqa: ANN001
    damping_per_s,  # noqa: ANN001
    leak_per_s,  # noqa: ANN001
    read,  # noqa: ANN001
    found,  # noqa: ANN001
):
    state = np.zeros(3)
    for k in range(1, time_s.shape[0]):
        _propagate(state, time_s[k] - time_s[k - 1], damping_per_s, leak_per_s)
        found[k] = innovation[k] + state[read]
        for i in range(3):
            state[i] += gains[k, i] * innovation[k]


@njit(cache=True, nogil=True)
def _cost(  # type: ignore[no-untyped-def]  # noqa: ANN202  # compiled: numba infers the types
    time_s,  # noqa: ANN001
    deviations,  # noqa: ANN001
    damping_per_s,  # noqa: ANN001
    leak_per_s,  # noqa: ANN001
    read,  # noqa: ANN001
    reading_var,  # noqa: ANN001
    torque_var,  # noqa: ANN001
    slip_per_s,  # noqa: ANN001
):
    state = np.zeros(3)
    covariance = (reading_var[0], 0.0, 0.0, _VAGUE_SPEED * reading_var[0], 0.0, torque_var[0])
    total = 0.0
    for k in range(1, time_s.shape[0]):
        dt = time_s[k] - time_s[k - 1]
        _propagate(state, dt, damping_per_s, leak_per_s)
        aa, av, ad, vv, vd, dd = carried(covariance, dt, damping_per_s, leak_per_s, torque_var[k])
        covariance = (aa + slip_per_s[k] * dt, av, ad, vv, vd, dd)
        seen = deviations[k]
        if seen != seen:  # not a number: nothing was read
            continue
        covariance, gain, variance = corrected(covariance, read == 1, reading_var[k])
        e = seen - state[read]
        total += 0.5 * (e * e / variance + math.log(6.283185307179586 * variance))
        state[0] += gain[0] * e
        state[1] += gain[1] * e
        state[2] += gain[2] * e
    return total


@njit(cache=True, nogil=True)
def _clean(  # type: ignore[no-untyped-def]  # noqa: ANN202  # compiled: numba infers the types
    time_s,  # noqa: ANN001
    predicted,  # noqa: ANN001
    known,  # noqa: ANN001
    standing,  # noqa: ANN001
    gains,  # noqa: ANN001
    std,  # noqa: ANN001
    damping_per_s,  # noqa: ANN001
    leak_per_s,  # noqa: ANN001
    read,  # noqa: ANN001
    quantum,  # noqa: ANN001
    own_std,  # noqa: ANN001
    torque_std,  # noqa: ANN001
    slipped,  # noqa: ANN001
    normals,  # noqa: ANN001
    found,  # noqa: ANN001
):
    """The true state less the plant's, and the observer's correction, step by step."""
    state = np.zeros(3)
    state[2] = torque_std * normals[0, 0]
    guess = np.zeros(3)
    for k in range(1, time_s.shape[0]):
        dt = time_s[k] - time_s[k - 1]
        if standing[k]:
            state[1] = 0.0
        else:
            _propagate(state, dt, damping_per_s, leak_per_s)
        forget = math.exp(-leak_per_s * dt)
        push = torque_std * math.sqrt(1.0 - forget * forget) * normals[k, 0]
        state[2] += push
        if not standing[k]:
            state[1] += 0.5 * dt * push
        state[0] += slipped[k]
        _propagate(guess, dt, damping_per_s, leak_per_s)
        if standing[k]:
            guess[1] = 0.0
        if not known[k]:
            continue
        truth = predicted[k] + state[read]
        seen = truth + own_std[k] * normals[k, 1]
        if quantum > 0.0:
            seen = quantum * math.floor(seen / quantum + 0.5)
        innovation = seen - predicted[k] - guess[read]
        found[k] = innovation / std[k]
        for i in range(3):
            guess[i] += gains[k, i] * innovation


forget_outdated(_cost, observer)
