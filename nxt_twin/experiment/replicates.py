"""How far a motor's fit errs: the same fit on synthetic recordings of the motor that was found.

An encoder's count repeats its rounding while the motor is slow or stands. A run keeps the lag at which it met the
bridge's co-processor. So the errors of neighbouring readings are correlated, and a covariance that takes them as
independent is too small. Synthetic recordings with these stamps, commands and counts carry this correlation. The
unknown torque that a fit of them shows is subtracted from the one found in the real recordings.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.linear import Linear, deviations
from nxt_twin.diagnose.fitting.noise import estimate
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import at_rest

_REPLICATES: Final = 200
_FEIGNED: Final = 8
"""Of the synthetic recordings, without any unknown torque, show how much of one they feign."""
_EXCHANGE_S: Final = 2e-3
"""The brick hands commands to the co-processor that drives the motors once in so long; polls keep step with it, so that
a whole run has one and the same lag, and the next run another."""
_STANDING_RAD: Final = 1e-6
"""A motor that moves less between two readings is held by dry friction against any unknown torque."""
_INDUCTANCE: Final = Slot("inductance", "winding")
_INDUCTANCE_DOUBT: Final = 0.15
"""Of a given inductance, which no fit moves."""
_MOVE: Final = 0.05


def fit_covariance(
    simulator: Simulator, linear: Linear, target: Target, lag_std_s: Mapping[str, float], rng: Generator
) -> FloatArray:
    """Covariance of the fit's variables, SI, shape (variables, variables).

    Args:
        simulator: for the plant's layout.
        linear: the fit; its runs begin at rest.
        target: the readings that it is about.
        lag_std_s: by how much the lags of a recording's commands differ on the link, by its name.
        rng: of the roundings, the lags and the unknown torque.
    """
    values, active = linear.structure.plant.vectors()
    turned = []
    for job in linear.jobs:
        shifted = _late(job.signals, lag_std_s[job.signals.name], rng)
        late = [free_job(one, at_rest(one)) for one in shifted]
        results = simulator.run(values[None], active[None], late)
        turned.append(np.array([result.predicted[0] for result in results]))
    noise = _beyond(simulator, linear, target, turned, rng)
    jobs = [
        replicate
        for job, angle_rad in zip(linear.jobs, turned, strict=True)
        for replicate in _replicates(job, angle_rad, noise, rng)
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


def _beyond(
    simulator: Simulator, linear: Linear, target: Target, turned: Sequence[FloatArray], rng: Generator
) -> Noise:
    """The noise with that part of the unknown torque which rounding and lag do not feign by themselves."""
    noise = linear.structure.noise
    calm = replace(noise, disturbance_std=0.0)
    made = [
        _replicates(job, angle_rad[:_FEIGNED], calm, rng)
        for job, angle_rad in zip(linear.jobs, turned, strict=True)
    ]
    plant = linear.structure.plant
    feigned = [
        estimate(simulator, plant, replace(target, jobs=jobs), noise, near=True)[0]
        for jobs in zip(*made, strict=True)
    ]
    left = noise.disturbance_std**2 - float(np.mean([each.disturbance_std**2 for each in feigned]))
    return replace(noise, disturbance_std=math.sqrt(max(left, 0.0)))


def _by_inductance(simulator: Simulator, linear: Linear) -> FloatArray:
    """The part of the uncertainty that the given inductance adds, in the variables' scales."""
    plant = linear.structure.plant
    if _INDUCTANCE not in plant.values:
        return np.zeros((len(linear.variables), len(linear.variables)))
    moved = plant.with_values({_INDUCTANCE: (1.0 + _MOVE) * plant.values[_INDUCTANCE]})
    shift = linear.absorbed(deviations(simulator, linear, [moved]))[0] * (_INDUCTANCE_DOUBT / _MOVE)
    return np.outer(shift, shift)


def _late(signals: Signals, lag_std_s: float, rng: Generator) -> list[Signals]:
    """The same commands: as early or late as a run may find the bridge's co-processor, and each as the link may be."""
    run_s = _EXCHANGE_S * (rng.random((_REPLICATES, 1)) - 0.5)
    link_s = lag_std_s * rng.standard_normal((_REPLICATES, signals.command_time_s.size))
    # None overtakes another.
    acted_s = np.sort(signals.command_time_s + run_s + link_s, axis=1)
    return [replace(signals, command_time_s=row) for row in acted_s]


def _replicates(job: Job, angle_rad: FloatArray, noise: Noise, rng: Generator) -> list[Job]:
    """Recordings like `job` of motors that turn by `angle_rad`, shape (replicates, samples), but for an unknown torque.

    Where within a count each begins is as likely here as there.
    """
    signals = job.signals
    turned = angle_rad + _pushed(signals, angle_rad, noise, rng)
    quantum = signals.quantum
    begins = quantum * rng.random((len(angle_rad), 1))
    own_std = math.sqrt(max(noise.reading_std**2 - quantum**2 / 12.0, 0.0))
    read = turned + begins + own_std * rng.standard_normal(turned.shape)
    counts = np.where(np.isfinite(signals.measured), quantum * np.floor(read / quantum), np.nan)
    made = [replace(signals, measured=row) for row in counts]
    return [replace(job, signals=one, start=at_rest(one)) for one in made]


def _pushed(signals: Signals, angle_rad: FloatArray, noise: Noise, rng: Generator) -> FloatArray:
    """How far an unknown torque turns the motor further, rad, shape (replicates, samples).

    To first order, with the observer's own model of it: a leaky random walk on a motor that forgets its speed.
    """
    found = np.zeros(angle_rad.shape)
    push = noise.disturbance_std * rng.standard_normal(len(angle_rad))
    speed = np.zeros(len(angle_rad))
    steps_s = np.diff(signals.time_s)
    stands = np.abs(np.diff(angle_rad[0])) < _STANDING_RAD
    for k, (step_s, still) in enumerate(zip(steps_s, stands, strict=True)):
        hold = math.exp(-noise.damping_per_s * step_s)
        forget = math.exp(-step_s / noise.disturbance_time_s)
        speed = np.zeros_like(speed) if still else hold * speed + step_s * push
        found[:, k + 1] = found[:, k] + step_s * speed
        fresh = rng.standard_normal(len(angle_rad))
        push = forget * push + math.sqrt(1.0 - forget**2) * noise.disturbance_std * fresh
    return found
