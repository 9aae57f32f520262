"""The recording that would tell two rivals apart, chosen by the evidence that it is expected to give.

Each input of a safe family is simulated with one rival and predicted with the other. The other is corrected by its
observer, and may re-fit as far as the present recordings leave it free. The expected log-likelihood ratio,
½·δᵀ(I + J·C·Jᵀ)⁻¹·δ, is what Hunter and Reiner's (1965) designs maximise, with the re-fit taken out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.fit import values_of
from nxt_twin.diagnose.fitting.likeness import told_apart
from nxt_twin.diagnose.fitting.linear import moves, with_slot_values
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.next.inputs import Pattern, family
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import at_rest
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.program import Run, Segment, commands

WANTED_NATS = 10.0  # expected evidence at which two rivals count as told apart
LONGEST_S = 600.0  # asked of a proposed input with its repeats, at most

_TRIED_S = 12.0  # of each input that is weighed, from its beginning
_STEP_S = 2e-3  # of a simulation that only weighs inputs
_SHORTEST_POLL_S = 0.005  # between readings of a simulated experiment
_SHORT_LIST = 4  # inputs that soonest tell the best fits apart: draws weigh them again
_DRAWS = 3  # plants of each rival, from what its recordings leave open
_LARGEST_MOVE = 0.01  # standard deviation of a draw along one direction, in the variables' scales, at most
_STALLED_S = 0.7  # an input that stalls the motor for as long, or longer, is not safe
_STALL_SHARE = 0.4  # of the largest recorded command: under more, a motor that stands is stalled
_STALL_SPEED = 0.02  # of the ordinary speed, below which a motor stands
_BOUND_TURNS = 3.0  # turns from its beginning; what has turned further turns freely


@final
@dataclass(frozen=True)
class Proposal:
    """An input and the evidence to expect of it.

    Attributes:
        pattern: the input.
        expected_nats: in `seconds`.
        seconds: how long it takes to `WANTED_NATS`, or `LONGEST_S` if that is not enough.
    """

    pattern: Pattern
    expected_nats: float
    seconds: float


@final
@dataclass(frozen=True)
class _Stage:
    """What all the simulated experiments have in common."""

    simulator: Simulator
    noise: Noise
    like: Signals
    poll_s: float
    supply_v: float
    most: float
    reach: float
    usual_speed: float


def propose(
    simulator: Simulator, problem: Problem, one: Structure, other: Structure, rng: Generator
) -> Proposal | None:
    """The input that soonest tells `one` from `other`; None where none of the family is safe or tells anything.

    Args:
        simulator: runs both plants.
        problem: whose commands, reach and polling the proposal keeps to.
        one: a rival; draws from the uncertainty of each are held against the other.
        other: the other rival.
        rng: for the draws.
    """
    stage = _stage(simulator, problem, one.noise)
    is_power = stage.like.input_kind == "power_pct"
    patterns = [p for p in family(most_pct(problem)) if is_power or not p.coasts]
    expected = _between(stage, patterns, (one, [one.plant]), (other, [other.plant]))
    safe = [n for n, curve in enumerate(expected) if curve is not None]
    likely = sorted(safe, key=lambda n: (_seconds(expected[n])[0], -_seconds(expected[n])[1]))[:_SHORT_LIST]
    draws = [[_drawn(structure, rng) for _ in range(_DRAWS)] for structure in (one, other)]
    averaged = _between(stage, [patterns[n] for n in likely], (one, draws[0]), (other, draws[1]))
    proposals = [
        Proposal(patterns[n], nats, seconds)
        for n, curve in zip(likely, averaged, strict=True)
        if curve is not None
        for seconds, nats in (_seconds(curve),)
    ]
    return min(proposals, key=lambda p: (p.seconds, -p.expected_nats)) if proposals else None


def _stage(simulator: Simulator, problem: Problem, noise: Noise) -> _Stage:
    signals = problem.signals
    steps = np.concatenate([np.diff(s.time_s[np.isfinite(s.measured)]) for s in signals])
    return _Stage(
        simulator=simulator,
        noise=noise,
        like=signals[0].alone(),
        poll_s=max(float(np.median(steps)), _SHORTEST_POLL_S),
        supply_v=float(np.nanmedian(np.concatenate([s.command_supply_v for s in signals]))),
        most=max(float(np.max(np.abs(s.command))) for s in signals),
        reach=bounded_reach(problem),
        usual_speed=problem.scale.speed,
    )


def bounded_reach(problem: Problem) -> float:
    """How far from its beginning a recording goes, rad or m; infinite for what has turned freely, round and round."""
    signals = problem.signals
    if signals[0].is_speed:
        return math.inf
    reach = max(
        float(np.nanmax(np.abs(s.measured - s.measured[np.isfinite(s.measured)][0]))) for s in signals
    )
    turns_freely = problem.plant.layout.frame != "linear" and reach > _BOUND_TURNS * 2.0 * math.pi
    return math.inf if turns_freely else reach


def most_pct(problem: Problem) -> int:
    """The largest power of the recordings, or 100 % of the largest command where that is no power."""
    if problem.signals[0].input_kind != "power_pct":
        return 100
    most = max(float(np.max(np.abs(s.command))) for s in problem.signals)
    return int(min(max(math.floor(100.0 * most + 1e-6), 20), 100))


def _signals(stage: _Stage, segments: Sequence[Segment]) -> Signals:
    """What a recording of these segments would hold, without its readings."""
    listed = list(commands(Run(name="tried", segments=tuple(segments))))
    length_s = sum(segment.duration_s for segment in segments)
    is_power = stage.like.input_kind == "power_pct"
    factor = 0.01 if is_power else 0.01 * stage.most
    time_s = np.arange(0.0, length_s, stage.poll_s)
    mode = [DRIVE_MODES.index(c.mode) if is_power else int(stage.like.command_mode[0]) for c in listed]
    return replace(
        stage.like,
        command_time_s=np.array([c.start_s for c in listed]),
        command=factor * np.array([float(c.power_pct) for c in listed]),
        command_mode=np.array(mode, dtype=np.int64),
        command_supply_v=np.full(len(listed), stage.supply_v),
        time_s=time_s,
        measured=np.zeros(time_s.size),
    )


def _between(
    stage: _Stage,
    patterns: Sequence[Pattern],
    one: tuple[Structure, Sequence[Plant]],
    other: tuple[Structure, Sequence[Plant]],
) -> list[FloatArray | None]:
    """The mean of what speaks against each of the two where draws from the other are the truth."""
    if not patterns:
        return []
    ways = zip(
        _expected(stage, patterns, one[1], other[0]),
        _expected(stage, patterns, other[1], one[0]),
        strict=True,
    )
    return [None if a is None or b is None else np.asarray(0.5 * (a + b)) for a, b in ways]


def _expected(
    stage: _Stage, patterns: Sequence[Pattern], truths: Sequence[Plant], other: Structure
) -> list[FloatArray | None]:
    """Expected nats after each second of `_TRIED_S` for each pattern, the mean over `truths`; None if unsafe."""
    signals = [_signals(stage, pattern.lasting(_TRIED_S)) for pattern in patterns]
    jobs = [replace(free_job(s, at_rest(s)), step_s=_STEP_S) for s in signals]
    vectors = [plant.vectors() for plant in truths]
    runs = stage.simulator.run(np.array([v for v, _ in vectors]), np.array([a for _, a in vectors]), jobs)
    safe = [_is_safe(stage, s, run.predicted) for s, run in zip(signals, runs, strict=True)]
    curves: list[list[FloatArray]] = [[] for _ in patterns]
    held, owners = [], []
    for number, (s, run) in enumerate(zip(signals, runs, strict=True)):
        for predicted in run.predicted if safe[number] else ():
            made = replace(s, measured=predicted)
            held.append(
                Job(made, observer(made, stage.noise), at_rest(made), stage.noise.disturbance_time_s, _STEP_S)
            )
            owners.append(number)
    for number, curve in zip(owners, _nats(stage.simulator, other, held), strict=True):
        curves[number].append(curve)
    return [np.asarray(np.mean(found, axis=0)) if found else None for found in curves]


def _nats(simulator: Simulator, other: Structure, jobs: Sequence[Job]) -> list[FloatArray]:
    """For each job, nats against `other` after 1, 2, … s."""
    if not jobs:
        return []
    variables = other.fitted.variables
    sets, widths = moves(other.plant, variables)
    _, active = other.plant.vectors()
    scale = np.array([v.scale for v in variables])
    free: FloatArray = np.asarray(
        np.linalg.pinv(other.fitted.covariance / np.outer(scale, scale), hermitian=True), dtype=np.float64
    )
    found = []
    for job, run in zip(
        jobs, simulator.run(sets, np.repeat(active[None], len(sets), axis=0), jobs), strict=True
    ):
        std = job.observer.innovation_std
        apart = np.nan_to_num((job.signals.measured - run.predicted[-1]) / std)
        slopes = np.nan_to_num((run.predicted[:-1:2] - run.predicted[1:-1:2]) / widths[:, None] / std)
        ends = np.searchsorted(job.signals.time_s, np.arange(1.0, _TRIED_S + 0.5)) - 1
        curve = [_left(free, slopes[:, : end + 1], apart[: end + 1]) for end in ends]
        found.append(np.maximum(np.array(curve), 0.0))
    return found


def _left(free: FloatArray, slopes: FloatArray, apart: FloatArray) -> float:
    """Nats of what is `apart` that no move along the `slopes` takes, with `free` for the prior's precision.

    Numbers that fix nothing may leave the equation singular: its shortest solution counts then.
    """
    along = slopes @ apart
    equation = free + slopes @ slopes.T + 1e-9 * np.eye(len(free))
    taken = np.linalg.lstsq(equation, along, rcond=None)[0]
    return 0.5 * float(apart @ apart - along @ taken)


def _is_safe(stage: _Stage, signals: Signals, predicted: FloatArray) -> bool:
    """No stall under a large command, no angle beyond what was recorded where the reach seems to be bounded."""
    if not np.isfinite(predicted).all():
        return False
    if not signals.is_speed and float(np.max(np.abs(predicted))) > 1.05 * stage.reach:
        return False
    speed = predicted if signals.is_speed else np.gradient(predicted, signals.time_s, axis=1)
    pushed = np.abs(signals.command_at_samples()) > _STALL_SHARE * max(stage.most, 1e-12)
    stalled = (np.abs(speed) < _STALL_SPEED * stage.usual_speed) & pushed
    longest = 0
    for row in stalled:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], row.astype(int), [0]])))
        longest = max(longest, int(np.max(edges[1::2] - edges[::2], initial=0)))
    return longest * stage.poll_s < _STALLED_S


def _seconds(curve: FloatArray | None) -> tuple[float, float]:
    """How long it takes to enough evidence, and how much it is then; what one try lacks, repeats add."""
    if curve is None or curve[-1] <= 0.0:
        return math.inf, 0.0
    reached = np.flatnonzero(curve >= WANTED_NATS)
    if reached.size:
        return float(reached[0] + 1), float(curve[reached[0]])
    seconds = min(_TRIED_S * WANTED_NATS / float(curve[-1]), LONGEST_S)
    return seconds, float(curve[-1]) * seconds / _TRIED_S


def _drawn(structure: Structure, rng: Generator) -> Plant:
    """The structure's plant with its parameters drawn from what the recordings leave open.

    Not between motors that move all alike, of which the rival has as many; and no direction moves by more than a
    little, for a rival would not follow further in the straight line that its slopes predict.
    """
    variables = structure.fitted.variables
    along = np.array([v.likeness / v.scale for v in variables]) * values_of(structure.plant, variables)
    scale = np.array([v.scale for v in variables])
    covariance = structure.fitted.covariance / np.outer(scale, scale)
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    stds = np.minimum(np.sqrt(np.maximum(values, 0.0)), _LARGEST_MOVE)
    drawn = vectors @ (stds * rng.standard_normal(values.size))
    offset = scale * told_apart(drawn[:, None], along)[:, 0]
    return with_slot_values(structure.plant, variables, values_of(structure.plant, variables) + offset)
