"""Judge plants on what no fit has seen, and whether what is left is noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.doubted import is_doubted
from nxt_twin.diagnose.fitting.observed import observed_starts
from nxt_twin.diagnose.fitting.problem import HeldOut, Problem
from nxt_twin.diagnose.fitting.residuals import Residuals
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import moving_start

_RIDGE = 3.0  # inverse prior variance of each weight, for innovations of variance 1
_FOLDS = 6  # of the cross-validation: each is predicted from all others
_SPEED_BINS = 8  # bins with equal numbers of readings
_BLOCK_S = 1.0  # s: readings of one block go into one fold
_RECENT_S = 0.05  # s: time constant with which the change of a command fades
_MOST_STALE = 0.5  # of the readings


@final
@dataclass(frozen=True)
class FreeRun:
    """A held-out recording run freely by one plant; arrays of shape (samples,), in SI units.

    `judged` marks the readings that count: held out, not a restart's own, and not stale.
    """

    held_out: HeldOut
    predicted: FloatArray
    stale: BoolArray
    judged: BoolArray

    @property
    def rms(self) -> float:
        """RMS error of the judged readings."""
        return _rms((self.held_out.signals.measured - self.predicted)[self.judged])


def free_runs(
    simulator: Simulator, problem: Problem, plant: Plant, best: Plant, noise: Noise
) -> list[FreeRun]:
    """Run `plant` freely over all that is held out; `best` and `noise` tell which readings are stale."""
    found = []
    for part in problem.held_out:
        stale = stale_readings(simulator, part.signals, best, noise)
        clean = replace(part.signals, measured=np.where(stale, np.nan, part.signals.measured))
        first = moving_start(part.signals)
        start = observed_starts(simulator, plant, clean, first, noise, problem.window_s)
        run = simulator.trace(plant, free_job(clean, start))
        judged = part.counted & ~stale & ~start.at
        found.append(FreeRun(part, run["predicted"], stale, judged))
    return found


def overall(runs: Sequence[FreeRun]) -> float:
    """RMS error over the judged readings of all runs, each reading alike."""
    errors = [(run.held_out.signals.measured - run.predicted)[run.judged] for run in runs]
    return _rms(np.concatenate(errors))


def leftover_nats(residuals: Residuals) -> float:
    """How much of the innovations a flexible function of the plant's state predicts, nats, out of fold.

    Speed in bins, direction, command, angle, time and what follows a command. A model that lacks nothing leaves
    innovations that nothing predicts, and this is then about zero or less.
    """
    return float(leftover_nats_of(residuals, residuals.normalised[None])[0])


def leftover_nats_of(residuals: Residuals, innovations: FloatArray) -> FloatArray:
    """The same for other `innovations` of the same readings, shape (cases, readings); shape (cases,)."""
    features = _features(residuals)
    block = np.floor(residuals.time_s / _BLOCK_S).astype(int) + 7 * residuals.run
    folds = [np.flatnonzero(block % _FOLDS == fold) for fold in range(_FOLDS)]
    power = [features[fold].T @ features[fold] for fold in folds]
    likeness = [features[fold].T @ innovations[:, fold].T for fold in folds]
    nats = np.zeros(len(innovations))
    for fold, own_power, own_likeness in zip(folds, power, likeness, strict=True):
        normal = sum(power) - own_power + _RIDGE * np.eye(features.shape[1])
        weights = np.linalg.solve(normal, sum(likeness) - own_likeness)
        asked = innovations[:, fold]
        nats += 0.5 * np.sum(asked**2 - (asked - (features[fold] @ weights).T) ** 2, axis=1)
    return nats


def _features(residuals: Residuals) -> FloatArray:
    speed = residuals.speed / max(_rms(residuals.speed), 1e-12)
    command = residuals.command / max(_rms(residuals.command), 1e-12)
    direction = np.sign(speed) * (np.abs(speed) > 1e-3)
    edges = np.quantile(speed, np.linspace(0.0, 1.0, _SPEED_BINS + 1))[1:-1]
    bins = np.eye(_SPEED_BINS)[np.searchsorted(edges, speed)]
    recent = np.exp(-residuals.since_command_s / _RECENT_S) * residuals.command_change
    turns = [wave(n * residuals.position) for n in (1, 2) for wave in (np.sin, np.cos)]
    elapsed = residuals.time_s / max(float(residuals.time_s.max()), 1e-9) - 0.5
    columns = [direction, command, np.abs(command), speed * command, recent, elapsed, elapsed * direction]
    columns += [np.square(speed) * direction, residuals.acceleration, np.abs(residuals.acceleration)]
    return np.column_stack([bins, *columns, *turns])


def stale_readings(simulator: Simulator, signals: Signals, plant: Plant, noise: Noise) -> BoolArray:
    """Readings that a fault in `plant` explains better than the motor's motion does, shape (samples,).

    None where those were most of them: a plant that doubts a recording does not choose what judges it.
    """
    if not any("outlier" in effect.terms for effect in plant.effects):
        return np.zeros(signals.time_s.size, dtype=bool)
    job = Job(signals, observer(signals, noise), moving_start(signals), noise.disturbance_time_s)
    weight = simulator.trace(plant, job)["weight"]
    read = np.isfinite(signals.measured) & ~job.start.at
    stale: BoolArray = read & is_doubted(plant, weight)
    return stale if np.sum(stale) <= _MOST_STALE * np.sum(read) else np.zeros_like(stale)


def _rms(errors: FloatArray) -> float:
    return float(np.sqrt(np.mean(errors**2))) if errors.size else float("nan")
