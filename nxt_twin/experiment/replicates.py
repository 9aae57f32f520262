"""How far a motor's fit errs: the same fit on made-up recordings of the motor that was found.

An encoder's count repeats its rounding while the motor is slow or stands, so that the errors of neighbouring readings
hang together, and a covariance that takes each for new is too small. Recordings with the same stamps, commands and
counts carry just that.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.diagnose.linear import Linear, deviations
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.recording.recording import FloatArray

_REPLICATES: Final = 200
_STANDING_RAD: Final = 1e-6
"""A motor that moves less between two readings is held by dry friction against any unknown torque."""
_INDUCTANCE: Final = Slot("inductance", "winding")
_INDUCTANCE_DOUBT: Final = 0.15
"""Of a given inductance, which no fit moves."""
_MOVE: Final = 0.05


def fit_covariance(simulator: Simulator, linear: Linear, rng: Generator) -> FloatArray:
    """Covariance of the fit's variables, SI, shape (variables, variables).

    Args:
        simulator: for the plant's layout.
        linear: the fit; its runs begin at rest.
        rng: of the roundings and the unknown torque.
    """
    plant = linear.structure.plant
    values, active = plant.vectors()
    jobs = [
        replicate
        for job in linear.jobs
        for replicate in _replicates(
            job,
            simulator.trace(plant, free_job(job.signals, at_rest(job.signals)))["predicted"],
            linear.structure.noise,
            rng,
        )
    ]
    results = simulator.run(values[None], active[None], jobs)
    parts = []
    for number, (gain, mask) in enumerate(zip(linear.gain, linear.counted, strict=True)):
        part = slice(number * _REPLICATES, (number + 1) * _REPLICATES)
        parts.append(
            np.array(
                [
                    ((job.signals.measured - result.predicted[0]) * gain)[mask]
                    for job, result in zip(jobs[part], results[part], strict=True)
                ]
            )
        )
    errors = linear.absorbed(np.concatenate(parts, axis=1))
    scale = np.array([variable.scale for variable in linear.variables])
    spread = errors.T @ errors / _REPLICATES + _by_inductance(simulator, linear)
    return np.asarray(spread * np.outer(scale, scale))


def _by_inductance(simulator: Simulator, linear: Linear) -> FloatArray:
    """What the doubt of the given inductance adds, in the variables' scales."""
    plant = linear.structure.plant
    if _INDUCTANCE not in plant.values:
        return np.zeros((len(linear.variables), len(linear.variables)))
    moved = plant.with_values({_INDUCTANCE: (1.0 + _MOVE) * plant.values[_INDUCTANCE]})
    shift = linear.absorbed(deviations(simulator, linear, [moved]))[0] * (_INDUCTANCE_DOUBT / _MOVE)
    return np.outer(shift, shift)


def _replicates(job: Job, angle_rad: FloatArray, noise: Noise, rng: Generator) -> list[Job]:
    """Recordings like `job` of a motor that turns by `angle_rad`, shape (samples,), but for an unknown torque.

    Where within a count each begins is as likely here as there.
    """
    signals = job.signals
    turned = angle_rad + _pushed(signals, angle_rad, noise, rng)
    quantum = signals.quantum
    begins = quantum * rng.random((_REPLICATES, 1))
    own_std = math.sqrt(max(noise.reading_std**2 - quantum**2 / 12.0, 0.0))
    read = turned + begins + own_std * rng.standard_normal(turned.shape)
    counts = np.where(np.isfinite(signals.measured), quantum * np.floor(read / quantum), np.nan)
    made = [replace(signals, measured=row) for row in counts]
    return [replace(job, signals=one, start=at_rest(one)) for one in made]


def _pushed(signals: Signals, angle_rad: FloatArray, noise: Noise, rng: Generator) -> FloatArray:
    """How far an unknown torque turns the motor further, rad, shape (replicates, samples).

    To first order, with the observer's own model of it: a leaky random walk on a motor that forgets its speed.
    """
    found = np.zeros((_REPLICATES, angle_rad.size))
    push = noise.disturbance_std * rng.standard_normal(_REPLICATES)
    speed = np.zeros(_REPLICATES)
    steps_s = np.diff(signals.time_s)
    stands = np.abs(np.diff(angle_rad)) < _STANDING_RAD
    for k, (step_s, still) in enumerate(zip(steps_s, stands, strict=True)):
        hold = math.exp(-noise.damping_per_s * step_s)
        forget = math.exp(-step_s / noise.disturbance_time_s)
        speed = np.zeros_like(speed) if still else hold * speed + step_s * push
        found[:, k + 1] = found[:, k] + step_s * speed
        fresh = rng.standard_normal(_REPLICATES)
        push = forget * push + math.sqrt(1.0 - forget**2) * noise.disturbance_std * fresh
    return found
