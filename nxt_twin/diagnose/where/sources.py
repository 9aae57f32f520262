"""Which equation fails: give each something of its own to be missing and see which makes the readings likeliest.

After Kristensen, Madsen and Jørgensen (2004): where a model lacks something, the equation that lacks it asks for
noise. That noise may have a shape (any function of speed, of angle, of the command, see `shapes`) or none.
All hypotheses are Gaussian with one variance each. They compete by the marginal likelihood of the re-fitted
baseline's innovations, with the re-fit's parameters integrated out. No hypothesis gains from being flexible.
Each also has the baseline's own unknown torque and reading noise, of any size. No effect of the library takes
part, so this also speaks where none is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Source, SourceFinding
from nxt_twin.diagnose.fitting.kalman import Randomness, cost, deviation, quiet
from nxt_twin.diagnose.fitting.linear import Linear, linearise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.where.marginal import likeliest
from nxt_twin.diagnose.where.noises import between, noises, readings_nats
from nxt_twin.diagnose.where.response import Entry
from nxt_twin.diagnose.where.shapes import RESTLESS, SHAPES, hats
from nxt_twin.diagnose.where.staged import Staged, answers, staged, whitened
from nxt_twin.physics.effect import Equation
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.simulate import Job, Simulator

SOURCE_OF: dict[Equation, Source] = {
    "torque_balance": "actuator",
    "electrical": "battery",
    "kinematic": "transmission",
    "measurement": "encoder",
    "timing": "clock_or_link",
}

_FORMLESS_NATS = 7.0  # what chance gives the best of all shapes less than once in a hundred clean cases
_SHIFTS_S = (4e-3, 8e-3, 0.013, 0.02, 0.03, 0.045, 0.065, 0.09)
_WANDERING_SHIFTS_S = (0.03, 0.065)
_LAGS_S = (5e-3, 0.015, 0.04)
_COARSE, _FINE = 8, 6
_LEAST_SIZE, _MOST_SIZE = 1e-3, 1e4

_Strength = tuple[Equation, float]


def sources(simulator: Simulator, problem: Problem, baseline: Structure) -> tuple[SourceFinding, ...]:
    """Strengths of all five equations, nats, the strongest first.

    The p-values hold the best of all hypotheses against what the best of as many gives by chance.
    """
    asked, complete = noises(simulator, problem, baseline)
    linears = [
        linearise(simulator, problem, replace(baseline, noise=noise))
        for noise in dict.fromkeys((asked, between(asked, complete)))
    ]
    scene = staged(simulator, problem, linears[0])
    heard = [_formless(scene, asked, complete)]
    for linear in linears:
        fitted = readings_nats(scene, linear) - readings_nats(scene, linears[0])
        heard += [(equation, fitted + gain) for equation, gain in _shaped(scene, linear)]
        heard += _shapeless(scene, asked, linear.structure.noise)
    best: dict[Equation, float] = dict.fromkeys(SOURCE_OF, 0.0)
    for equation, nats in heard:
        best[equation] = max(best[equation], nats)
    found = [
        SourceFinding(SOURCE_OF[equation], equation, nats, _p_value(nats, len(heard)))
        for equation, nats in best.items()
    ]
    return tuple(sorted(found, key=lambda finding: -finding.strength))


def _p_value(nats: float, tries: int) -> float:
    """Of a likelihood ratio for a variance that cannot be negative, half a chi-square of one degree of freedom."""
    return min(tries * 0.5 * math.erfc(math.sqrt(nats)), 1.0)


def _formless(scene: Staged, asked: Noise, complete: Noise) -> _Strength:
    """What is missing without a shape: a torque or an error of readings, by what the baseline needs more of.

    However strong, it counts for no more than the best of all shapes may come to by chance.
    """
    least = _total(scene, asked)
    torque = _total(scene, replace(asked, disturbance_std=complete.disturbance_std)) - least
    reading = _total(scene, replace(asked, reading_std=complete.reading_std)) - least
    equation: Equation = "measurement" if reading > torque else "torque_balance"
    return equation, min(max(torque, reading), _FORMLESS_NATS)


def _shaped(scene: Staged, linear: Linear) -> list[_Strength]:
    """What each family of shapes gains over the unknown torque and reading noise of `linear` alone, nats."""
    found: list[_Strength] = []
    for shape in SHAPES:
        rows = (shape.rows(course, scene.unit) for course in scene.courses)
        found.append((shape.equation, likeliest(linear, answers(scene, linear, rows, shape.entry))))
    moved = _moved(scene, linear)
    late = np.array([whitened(linear, parts) for parts in moved])
    found += [("timing", likeliest(linear, [late[n : n + 2]])) for n in range(len(late) - 1)]
    found.append(("timing", likeliest(linear, _wandering(scene, linear, moved))))
    found.append(("electrical", likeliest(linear, [_lagging(late)])))
    return found


def _moved(scene: Staged, linear: Linear) -> list[list[FloatArray]]:
    """By how much the predicted readings move with all commands late by each of some shifts, by job, SI."""
    values, active = linear.structure.plant.vectors()
    jobs = [_late(job, shift_s) for shift_s in _SHIFTS_S for job in linear.jobs]
    results = iter(scene.simulator.run(values[None], active[None], jobs))
    return [[np.nan_to_num(next(results).predicted[0] - own) for own in linear.predicted] for _ in _SHIFTS_S]


def _late(job: Job, shift_s: float) -> Job:
    return replace(job, signals=replace(job.signals, command_time_s=job.signals.command_time_s + shift_s))


def _wandering(scene: Staged, linear: Linear, moved: Sequence[Sequence[FloatArray]]) -> Iterator[FloatArray]:
    """Shifts that change with time."""
    some = [moved[_SHIFTS_S.index(shift_s)] for shift_s in _WANDERING_SHIFTS_S]
    return answers(scene, linear, _wandering_rows(scene, linear, some), "reading")


def _wandering_rows(
    scene: Staged, linear: Linear, moved: Sequence[Sequence[FloatArray]]
) -> Iterator[FloatArray]:
    noise = linear.structure.noise
    for job, course, own, *shifted in zip(linear.jobs, scene.courses, linear.predicted, *moved, strict=True):
        still = deviation(job, own, noise)
        errors = np.array([np.nan_to_num(still - deviation(job, own + shift, noise)) for shift in shifted])
        parts = hats(course.laid_s, scene.unit.quick_s)
        yield (errors[:, None] * parts).reshape(-1, own.size)


def _lagging(late: FloatArray) -> FloatArray:
    """What follows a command with a lag follows a mixture of later and later commands."""
    edges_s = [0.0, *(math.sqrt(one * other) for one, other in pairwise(_SHIFTS_S)), math.inf]
    shares = [
        [math.exp(-low_s / lag_s) - math.exp(-high_s / lag_s) for low_s, high_s in pairwise(edges_s)]
        for lag_s in _LAGS_S
    ]
    return np.array(shares) @ late


def _shapeless(scene: Staged, asked: Noise, noise: Noise) -> list[_Strength]:
    """What noise in one equation, of a size that changes with what the plant does, gains over `asked`, nats."""
    none = _total(scene, asked)
    scales = {
        "torque": asked.disturbance_std**2,
        "count": asked.reading_std**2,
        "reading": asked.reading_std**2,
    }
    found: list[_Strength] = []
    for restless in RESTLESS:
        weights = [restless.weights(course, scene.unit) for course in scene.courses]
        least = _least(partial(_total, scene, noise, restless.entry, weights), scales[restless.entry])
        found.append((restless.equation, none - least))
    return found


def _total(
    scene: Staged,
    noise: Noise,
    entry: Entry = "reading",
    weights: Sequence[FloatArray] = (),
    size: float = 0.0,
) -> float:
    """Negative log-likelihood of the deviations under `noise`, and `weights` times `size` more, nats."""
    total = 0.0
    for number, (course, found) in enumerate(zip(scene.courses, scene.deviations, strict=True)):
        randomness = quiet(course.job, noise)
        if size > 0.0:
            randomness = _more(randomness, entry, size * weights[number])
        total += cost(course.job, found, noise, randomness)
    return scene.evidence * total


def _more(randomness: Randomness, entry: Entry, variances: FloatArray) -> Randomness:
    match entry:
        case "torque":
            return replace(randomness, torque=randomness.torque + variances)
        case "count":
            return replace(randomness, slip_per_s=randomness.slip_per_s + variances)
        case "reading":
            return replace(randomness, reading=randomness.reading + variances)


def _least(value: Callable[[float], float], scale: float) -> float:
    """The least value over sizes about `scale`, by a coarse and a finer grid in logarithms."""
    low, high, least = _LEAST_SIZE * scale, _MOST_SIZE * scale, math.inf
    for count in (_COARSE, _FINE):
        sizes = np.geomspace(low, high, count)
        values = [value(float(size)) for size in sizes]
        best = int(np.argmin(values))
        least = min(least, values[best])
        low, high = sizes[max(best - 1, 0)], sizes[min(best + 1, count - 1)]
    return least
