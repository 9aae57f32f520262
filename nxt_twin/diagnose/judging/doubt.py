"""How far simulations of what is held out may err: parameters and stamps are left open, and readings may stray."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from scipy.special import ndtri

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fit import values_of
from nxt_twin.diagnose.fitting.late_rows import with_drawn_moments
from nxt_twin.diagnose.fitting.linear import with_slot_values
from nxt_twin.diagnose.fitting.observed import observed_starts
from nxt_twin.diagnose.fitting.problem import HeldOut, Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.horizons import horizons_of
from nxt_twin.physics.observer import free
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import Start, moving_start, run_in

_DRAWS = 8  # of the moments of rows
_NINE_OF_TEN = 1.28  # standard deviations above a normal's mean, below which nine of ten lie
_TINY = 1e-6  # of the largest variance: directions that move nothing


def doubts_of(
    simulator: Simulator, problem: Problem, structure: Structure, covariance: FloatArray
) -> tuple[float, ...]:
    """The RMS standard deviation of simulated held-out readings at each horizon, SI.

    Held-out recordings may do what the fitted ones never did, such as coast. There a small doubt in a parameter may
    mean a large error, and that error says nothing of physics.

    `covariance` is of the variables of `structure`, SI, shape (variables, variables).
    """
    plants = _moved(structure, covariance)
    if not plants:
        return (0.0,) * len(horizons_of(problem))
    found = []
    for horizon_s in horizons_of(problem):
        spread = [_spread(simulator, part, structure, plants, horizon_s) for part in problem.held_out]
        found.append(float(np.sqrt(np.mean(np.concatenate(spread)))))
    return tuple(found)


def scatter_of(simulator: Simulator, problem: Problem, plant: Plant) -> float:
    """The RMS by which `plant` lets held-out readings stray beyond ordinary noise, as held readings do, SI."""
    found = [straying(simulator, plant, part.signals)[part.counted] for part in problem.held_out]
    every = np.concatenate(found)
    return float(np.sqrt(np.mean(every[np.isfinite(every)])))


def lateness_of(
    simulator: Simulator, problem: Problem, structure: Structure, rng: Generator
) -> tuple[float, ...]:
    """The RMS below which held-out readings err nine times of ten as moments of rows are open, at each horizon, SI.

    Stamps tell when a row was taken, and when its command came to act, up to what they leave open. A few commands may
    make most of the error, so that a mean would be passed often.
    """
    found = []
    for horizon_s in horizons_of(problem):
        errors = [_late(simulator, part, structure, horizon_s, rng) for part in problem.held_out]
        drawn = np.sqrt(np.mean(np.concatenate(errors, axis=1), axis=1))
        found.append(float(np.mean(drawn) + _NINE_OF_TEN * np.std(drawn)))
    return tuple(found)


def straying(simulator: Simulator, plant: Plant, signals: Signals) -> FloatArray:
    """By which variance each reading of a free run may stray beyond ordinary noise, SI, shape (samples,).

    NaN where nothing was read.
    """
    if not any(effect.holds_readings for effect in plant.effects):
        return np.zeros(signals.time_s.size)
    values, active = plant.vectors()
    active &= np.array(["outlier" not in effect.terms for effect in plant.layout.effects])
    signals = signals.of_known_moments()  # which others draw
    job = Job(signals, free(signals, 1.0), moving_start(signals))
    weight = simulator.run(values[None], active[None], [job])[0].weight[0]
    return 1.0 / np.where(weight > 0.0, weight, np.nan) - 1.0  # ordinary noise has a variance of 1 here


def drawn(structure: Structure, covariance: FloatArray, count: int, rng: Generator) -> list[Plant]:
    """Plants that the readings leave open, as far off as `covariance` says, each principal direction in `count` strata.

    `covariance` is as in `doubts_of`.
    """
    own = values_of(structure.plant, structure.fitted.variables)
    strata = ndtri((np.arange(count) + 0.5) / count)
    steps = _steps(structure, covariance)
    off = np.array([rng.permutation(strata) for _ in steps]).reshape(len(steps), count)
    return [
        with_slot_values(structure.plant, structure.fitted.variables, own + each @ steps) for each in off.T
    ]


def _moved(structure: Structure, covariance: FloatArray) -> list[Plant]:
    """The plant moved by one standard deviation along each principal direction, forth and back in turn."""
    variables = structure.fitted.variables
    own = values_of(structure.plant, variables)
    return [
        with_slot_values(structure.plant, variables, own + sign * step)
        for step in _steps(structure, covariance)
        for sign in (1, -1)
    ]


def _steps(structure: Structure, covariance: FloatArray) -> FloatArray:
    """One standard deviation along each principal direction, SI, shape (directions, variables)."""
    scale = np.array([variable.scale for variable in structure.fitted.variables])
    if not scale.size:
        return np.zeros((0, 0))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    kept = values > max(_TINY * float(values[-1]), 1e-300)
    return np.asarray((vectors[:, kept] * np.sqrt(values[kept])).T * scale)


def _spread(
    simulator: Simulator, part: HeldOut, structure: Structure, plants: list[Plant], horizon_s: float
) -> FloatArray:
    """The variance of each judged reading, SI, shape (readings,)."""
    start = _start(simulator, part, structure, horizon_s)
    judged = part.counted & ~start.at
    vectors = [plant.vectors() for plant in plants]
    values = np.array([values for values, _ in vectors])
    active = np.array([active for _, active in vectors])
    job = free_job(part.signals, start)
    predicted = simulator.run(values, active, [job])[0].predicted[:, judged]
    half = (predicted[::2] - predicted[1::2]) / 2.0
    return np.asarray(np.sum(np.nan_to_num(half) ** 2, axis=0))


def _late(
    simulator: Simulator, part: HeldOut, structure: Structure, horizon_s: float, rng: Generator
) -> FloatArray:
    """The square of each judged reading's error by drawn moments of the rows, SI, shape (draws, readings)."""
    start = _start(simulator, part, structure, horizon_s)
    judged = part.counted & ~start.at
    if part.signals.late_open <= 0.0 and not part.signals.open_s.any():
        return np.zeros((_DRAWS, int(judged.sum())))
    drawn = [part.signals] + [with_drawn_moments(part.signals, rng) for _ in range(_DRAWS)]
    values, active = structure.plant.vectors()
    runs = simulator.run(values[None], active[None], [free_job(signals, start) for signals in drawn])
    exact, *late = (run.predicted[0, judged] for run in runs)
    return np.asarray([np.nan_to_num(other - exact) ** 2 for other in late])


def _start(simulator: Simulator, part: HeldOut, structure: Structure, horizon_s: float) -> Start:
    start = moving_start(part.signals)
    if np.isfinite(horizon_s) or run_in(part.signals).any():
        return observed_starts(simulator, structure.plant, part.signals, start, structure.noise, horizon_s)
    return start
