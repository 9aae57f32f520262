"""How far off a plant is over what no fit has seen, by how long it has been simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.observed import observed_starts
from nxt_twin.diagnose.fitting.problem import HeldOut, Problem
from nxt_twin.diagnose.fitting.splits import WINDOW_S
from nxt_twin.diagnose.judging.judge import stale_readings
from nxt_twin.physics.observer import Noise, free_run_std
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Simulator, free_job
from nxt_twin.physics.start import Start, moving_start, restarts

_SLACK = 1.02  # ratio of errors of windows up to 2 s, below which a difference is chance
_SLACK_OF_DRIFT = 1.1  # a whole run is one number, in which much is luck
_LONG_S = 1e6  # stands for a whole recording
HORIZONS_S = (0.5, 2.0, 10.0, np.inf)
"""Lengths of the simulated windows, s; inf is a whole recording."""


@final
@dataclass(frozen=True)
class Errors:
    """RMS error over all held-out readings at each of `HORIZONS_S` that the recordings are long enough for, SI."""

    seconds: tuple[float, ...]
    rms: tuple[float, ...]

    def at(self, seconds: float) -> float:
        """The error at one of the horizons."""
        return self.rms[self.seconds.index(seconds)]


def horizons_of(problem: Problem) -> tuple[float, ...]:
    """Those of `HORIZONS_S` that are shorter than the longest recording; the whole always."""
    longest = max(float(part.signals.time_s[-1] - part.signals.time_s[0]) for part in problem.held_out)
    return tuple(seconds for seconds in HORIZONS_S if seconds < longest or np.isinf(seconds))


def errors_of(simulator: Simulator, problem: Problem, plant: Plant, best: Plant, noise: Noise) -> Errors:
    """Simulate `plant` over all that is held out; `best` and `noise` tell which readings are stale.

    Each window starts from the state that the plant, corrected at each reading until then, has reached.
    """
    clean = [(part, _without_stale(simulator, part, best, noise)) for part in problem.held_out]
    begun = [(part, signals, moving_start(signals)) for part, signals in clean]
    seconds = horizons_of(problem)
    found = []
    for horizon_s in seconds:
        errors = [_errors(simulator, *one, plant, noise, horizon_s) for one in begun]
        found.append(_rms(errors))
    return Errors(seconds, tuple(found))


def floors_of(problem: Problem, noise: Noise, reached: Sequence[Errors]) -> tuple[float, ...]:
    """The RMS error of a model that lacks nothing, at each horizon: what noise makes of a simulation, SI.

    Linear theory says how an unknown torque's effect grows. It assumes that the torque also acts at rest,
    where friction holds the motor. The floor is therefore scaled to the errors of fitted simulated readings.
    No floor lies above what some plant has `reached`.
    """
    scale = min(noise.drift, 1.0)
    found = []
    for number, horizon_s in enumerate(reached[0].seconds):
        variances = []
        for part in problem.held_out:
            start = restarts(part.signals, horizon_s)
            variances.append((free_run_std(part.signals, noise, start) ** 2)[part.counted & ~start.at])
        quantum = max(part.signals.quantum for part in problem.held_out)
        mean = float(np.mean(np.concatenate(variances)))
        floor = float(np.sqrt(max(scale**2 * mean, quantum**2 / 12.0)))
        found.append(min(floor, *(errors.rms[number] for errors in reached)))
    return tuple(found)


def nearest_horizon(errors: Errors, seconds: float) -> int:
    """The number of the horizon that is nearest to `seconds`, in logarithms."""
    return int(np.argmin([abs(np.log(min(own, _LONG_S) / seconds)) for own in errors.seconds]))


def best_at_every_horizon(ranked: Sequence[tuple[Plant, Errors]], tolerance: float) -> Plant:
    """The first plant that no later one beats at any horizon by more than chance, above what does not matter.

    Where each but the last is beaten somewhere, the one with the least error over all horizons, in logarithms, of those
    after the first.
    """
    for number, (plant, errors) in enumerate(ranked):
        rivals = [other for _, other in ranked[number + 1 :]]
        if rivals and not any(_beats(rival, errors, tolerance).any() for rival in rivals):
            return plant
    return ranked[1 + least_wrong([errors for _, errors in ranked[1:]], tolerance)][0]


def beaten_at(plant: Plant, ranked: Sequence[tuple[Plant, Errors]], tolerance: float) -> tuple[float, ...]:
    """The horizons at which another of the ranked plants beats `plant`, s."""
    own = next(errors for other, errors in ranked if other is plant)
    beaten = np.any([_beats(errors, own, tolerance) for _, errors in ranked], axis=0)
    return tuple(seconds for seconds, worse in zip(own.seconds, beaten, strict=True) if worse)


def _beats(one: Errors, other: Errors, tolerance: float) -> BoolArray:
    """At which horizons `one` is better than `other` by more than chance, where that errs by what matters."""
    slack = np.where(np.array(one.seconds) <= WINDOW_S, _SLACK, _SLACK_OF_DRIFT)
    return np.asarray(np.array(other.rms) > np.maximum(slack * np.array(one.rms), tolerance))


def least_wrong(every: Sequence[Errors], tolerance: float) -> int:
    """Which has the least error over all horizons, in logarithms, above what does not matter."""
    sizes = [float(np.sum(np.log(np.maximum(errors.rms, max(tolerance, 1e-15))))) for errors in every]
    return int(np.argmin(sizes))


def _errors(
    simulator: Simulator,
    part: HeldOut,
    signals: Signals,
    first: Start,
    plant: Plant,
    noise: Noise,
    horizon_s: float,
) -> FloatArray:
    start = first
    if np.isfinite(horizon_s) or first.speed[0] != 0.0:  # where it may be wrong, so that a run-in is needed
        start = observed_starts(simulator, plant, signals, first, noise, horizon_s)
    predicted = simulator.trace(plant, free_job(signals, start))["predicted"]
    judged = part.counted & np.isfinite(signals.measured) & ~start.at
    return np.asarray((signals.measured - predicted)[judged])


def _without_stale(simulator: Simulator, part: HeldOut, best: Plant, noise: Noise) -> Signals:
    stale = stale_readings(simulator, part.signals, best, noise)
    return replace(part.signals, measured=np.where(stale, np.nan, part.signals.measured))


def _rms(errors: Sequence[FloatArray]) -> float:
    every = np.concatenate(errors)
    with np.errstate(over="ignore"):  # a run that ran away errs infinitely
        return float(np.sqrt(np.mean(every**2))) if np.isfinite(every).all() else float("inf")
