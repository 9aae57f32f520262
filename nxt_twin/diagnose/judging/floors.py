"""The errors that a correct model would reach: synthetic recordings of the final model, re-fitted and judged."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.random import Generator
from scipy.special import ndtri

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.late_rows import with_drawn_moments
from nxt_twin.diagnose.fitting.problem import HeldOut, Problem
from nxt_twin.diagnose.fitting.splits import WINDOW_S
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.judging.doubt import drawn, straying
from nxt_twin.diagnose.judging.horizons import Errors, errors_of
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise, Observer, slips
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator
from nxt_twin.physics.start import moving_start, restarts

REPLICATES: Final = 8  # synthetic recordings of each real one, every set of which is re-fitted once
MOSTLY: Final = 0.9
"""The share of synthetic recordings on which the re-fitted model errs by less than the floor."""
DRY_FRICTION_OFF: Final = 0.1
"""How far dry friction is off its law (a standard deviation, as a share), where a model lacks nothing else.

Learnt over the four truth families, seed 901: with it the true structure stays below the floor nine times of ten.
"""
_DRY: Final = Slot("coulomb_friction", "coulomb")
_HUGE: Final = 1e12  # SI unit of the readings: stands for the error of a re-fit that ran away
_TINY: Final = 1e-15  # SI unit of the readings: keeps a ratio of errors finite
_FAINT: Final = 1e-9  # gain under which a reading that is this much larger gives the unknown torque its step


def refitted_floors(
    simulator: Simulator,
    problem: Problem,
    final: Structure,
    covariance: FloatArray,
    reached: Sequence[Errors],
    rng: Generator,
    *,
    complete: bool,
) -> tuple[float, ...]:
    """The error on held-out readings that a correct model stays below nine times of ten, at each horizon, SI.

    The truth is `final`, off by what readings leave open: held-out ones may do what no fitted one did, such as coast. A
    synthetic recording has the inputs, stamps and quantum of a real one. It has the noise's unknown torque, against
    which dry friction holds, and strays where an effect lets readings do so. `final` is re-fitted to such
    recordings, by windows of simulation. Even the equations of a `complete` model are a little off. Its dry friction
    is therefore judged off by `DRY_FRICTION_OFF`, and floors grow where it simulates fitted readings worse
    than synthetic ones. Errors that are too small to show in windows add up in longer simulations. Where its windows
    are at their floors, nothing shows that a correct model would err less in these. No floor lies above what some plant
    has `reached` on the real ones, of which the last is the error of `final`.
    """
    truths = drawn(final, covariance, REPLICATES, rng)
    offs = [math.exp(off if complete else 0.0) for off in _offs(rng)]
    replicates = [
        (_read_anew(simulator, problem, final, truth, rng), off)
        for truth, off in zip(truths, offs, strict=True)
    ]
    made = simulator.abreast(lambda one: _refitted(simulator, final, *one), replicates)
    # A re-fit that ran away counts as large, and not as none.
    held = np.nan_to_num(np.array([errors.rms for errors, _ in made]), posinf=_HUGE)
    floors = np.quantile(held, MOSTLY, axis=0)
    if complete:
        real = errors_of(simulator, _seen(problem), final.plant, final.plant, final.noise)
        floors = floors * _off(reached[0].seconds, real, [errors for _, errors in made])
    if complete and _at_the_floor(reached[-1], floors, problem.tolerance):
        floors = np.where(np.array(reached[-1].seconds) > WINDOW_S, np.inf, floors)
    return tuple(float(min(own)) for own in zip(floors, *(errors.rms for errors in reached), strict=True))


def _at_the_floor(errors: Errors, floors: FloatArray, tolerance: float) -> bool:
    """Whether no window of two seconds or shorter errs by more than its floor and the tolerance."""
    own = zip(errors.seconds, errors.rms, floors, strict=True)
    return all(rms <= floor + tolerance for seconds, rms, floor in own if seconds <= WINDOW_S)


def _offs(rng: Generator) -> FloatArray:
    """How far dry friction is off in each synthetic recording, in logarithms: a normal's quantiles, shuffled."""
    return np.asarray(rng.permutation(DRY_FRICTION_OFF * ndtri((np.arange(REPLICATES) + 0.5) / REPLICATES)))


def _off(seconds: Sequence[float], real: Errors, made: Sequence[Errors]) -> FloatArray:
    """How many times worse fitted readings are simulated than synthetic ones, at each horizon; 1 at least."""
    found = np.ones(len(seconds))
    for number, horizon_s in enumerate(seconds):
        if horizon_s in real.seconds:
            usual = float(np.median([errors.at(horizon_s) for errors in made]))
            found[number] = max(1.0, real.at(horizon_s) / max(usual, _TINY))
    return found


def _seen(problem: Problem) -> Problem:
    """The problem with all readings that are not held out in the place of those that are."""
    held = {part.signals.name: part.counted for part in problem.held_out}
    parts = [
        HeldOut(
            signals,
            restarts(signals, problem.window_s),
            np.isfinite(signals.measured)
            & ~held.get(signals.name, np.zeros(signals.time_s.size, dtype=bool)),
        )
        for signals in problem.signals
    ]
    return replace(problem, held_out=tuple(parts))


def _read_anew(
    simulator: Simulator, problem: Problem, final: Structure, truth: Plant, rng: Generator
) -> Problem:
    """The problem with synthetic recordings of `truth` in the place of the real ones."""
    every = [*problem.signals, *(part.signals for part in problem.held_out)]
    made = {signals.name: synthetic(simulator, truth, signals, final.noise, rng) for signals in every}
    return _instead(problem, made)


def _refitted(
    simulator: Simulator, final: Structure, own: Problem, friction_times: float
) -> tuple[Errors, Errors]:
    """The errors of a re-fit to synthetic recordings: on held-out readings, and on those that were fitted.

    Held-out readings are judged with the re-fit's dry friction taken `friction_times`.
    """
    plant, noise = final.plant, final.noise
    fitted = Fitter(simulator, own).simulating(plant, noise, everything=True, rounds=1)[0].plant
    judged = _rubbing(fitted, friction_times)
    return errors_of(simulator, own, judged, judged, noise), errors_of(
        simulator, _seen(own), fitted, fitted, noise
    )


def _rubbing(plant: Plant, times: float) -> Plant:
    """The plant with so many times its dry friction, where it has any."""
    return plant.with_values({_DRY: times * plant.values[_DRY]}) if _DRY in plant.values else plant


def synthetic(simulator: Simulator, plant: Plant, signals: Signals, noise: Noise, rng: Generator) -> Signals:
    """`signals` as they would have been, were `plant` the truth."""
    rows = signals.time_s.size
    forget = np.exp(-np.diff(signals.time_s, prepend=signals.time_s[0]) / noise.disturbance_time_s)
    pushes = noise.disturbance_std * np.sqrt(1.0 - forget**2) * rng.standard_normal(rows)
    gains = np.zeros((rows, 3))
    gains[:, 2] = _FAINT
    pushed = replace(with_drawn_moments(signals, rng), measured=pushes / _FAINT)
    job = Job(pushed, Observer(gains, np.zeros(rows)), moving_start(signals), noise.disturbance_time_s)
    exact = simulator.trace(plant, job)["predicted"]
    quantum = 0.0 if signals.is_speed else signals.quantum
    own_std = math.sqrt(max(noise.reading_std**2 - quantum**2 / 12.0, 0.0))
    strays = np.nan_to_num(straying(simulator, plant, signals))
    read = exact + np.sqrt(own_std**2 + strays) * rng.standard_normal(rows)
    if noise.slip:
        read += np.cumsum(np.sqrt(slips(signals, noise)) * rng.standard_normal(rows))
    if quantum > 0.0:
        read = quantum * np.round(read / quantum)
    return replace(signals, measured=np.where(np.isfinite(signals.measured), read, np.nan))


def _instead(problem: Problem, made: Mapping[str, Signals]) -> Problem:
    """The problem with other readings, each split as before."""
    return replace(
        problem,
        target=_target(problem.target, made),
        simulated=_target(problem.simulated, made),
        held_out=tuple(replace(part, signals=made[part.signals.name]) for part in problem.held_out),
        signals=tuple(made[signals.name] for signals in problem.signals),
    )


def _target(target: Target, made: Mapping[str, Signals]) -> Target:
    jobs = []
    for job in target.jobs:
        whole = made[job.signals.name]
        rows = np.searchsorted(whole.time_s, job.signals.time_s)
        jobs.append(replace(job, signals=replace(job.signals, measured=whole.measured[rows])))
    return replace(target, jobs=tuple(jobs))
