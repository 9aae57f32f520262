"""A fitted structure as a linear regression: what its readings do when parameters move or an effect comes in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.fitting.batch import batch_predictions, batches, samples_of
from nxt_twin.diagnose.fitting.braking import braked_alike, measured_along
from nxt_twin.diagnose.fitting.fit import Variable, values_of
from nxt_twin.diagnose.fitting.likeness import told_apart
from nxt_twin.diagnose.fitting.noise import with_noise
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure, step_for
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.diagnose.fitting.variables import starts_of
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Result, Simulator

_DIFFERENCE = 2e-3  # between parameter sets of a slope, in units of a variable
_SCREEN_STEP_S = 2e-3  # of a simulation that only ranks effects
_LARGEST_LOAD = 0.5  # share of the inertia that a screened load may take from the body
_LARGEST_SIGNATURE = 1e4  # in standard deviations; a run that blew up is no better than that


@final
@dataclass(frozen=True)
class Linear:
    """Innovations of a structure and their slopes, everything in standard deviations of the innovations.

    Attributes:
        structure: what it is about.
        jobs: the recordings, under the gains that suit the structure's noise.
        counted: which samples of each job make up the readings.
        innovations: shape (readings,), jobs one after another.
        slopes: of the prediction for each variable, in the variable's scale, shape (variables, readings).
        tightness: of the weak priors in the same scale, inverse variances, shape (variables,).
        run: the job of each reading, shape (readings,).
        time_s: since the job's first sample, shape (readings,).
        checks: the readings that only check a choice, shape (readings,).
        gain: factor that each sample's deviation is multiplied with, per job, shape (samples,).
        predicted: of the structure, per job, SI, shape (samples,).
    """

    structure: Structure
    jobs: tuple[Job, ...]
    counted: tuple[BoolArray, ...]
    innovations: FloatArray
    slopes: FloatArray
    tightness: FloatArray
    run: IntArray
    time_s: FloatArray
    checks: BoolArray
    gain: tuple[FloatArray, ...]
    predicted: tuple[FloatArray, ...]

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The variables that the re-fit may move."""
        return self.structure.fitted.variables

    def absorbed(self, signatures: FloatArray, kept: BoolArray | None = None) -> FloatArray:
        """Shares of each variable, (signatures, variables), that take up `signatures` best on the `kept` readings."""
        slopes, wanted = self.slopes, np.atleast_2d(signatures)
        if kept is not None:
            slopes, wanted = slopes[:, kept], wanted[:, kept]
        return self.shares_of(slopes @ wanted.T, kept)

    def shares_of(self, common: FloatArray, kept: BoolArray | None = None) -> FloatArray:
        """The same by the products of slopes and signatures summed over readings, shape (variables, signatures)."""
        slopes = self.slopes if kept is None else self.slopes[:, kept]
        normal = slopes @ slopes.T + np.diag(self.tightness) + 1e-9 * np.eye(self.tightness.size)
        return np.asarray(np.linalg.solve(normal, common).T)

    def left_of(self, signatures: FloatArray, kept: BoolArray | None = None) -> FloatArray:
        """The part of `signatures` that the re-fit cannot absorb, shape (signatures, readings).

        With `kept`, the re-fit sees only those readings and the others are predicted by it.
        """
        left = np.asarray(self.absorbed(signatures, kept) @ self.slopes)
        return np.subtract(np.atleast_2d(signatures), left, out=left)  # of an hour, each copy is 60 MB

    def whitened(self, results: Sequence[Result]) -> FloatArray:
        """Predictions of several parameter sets, less the structure's own, shape (sets, readings)."""
        parts = [
            ((result.predicted - own) * gain)[:, mask]
            for result, own, gain, mask in zip(results, self.predicted, self.gain, self.counted, strict=True)
        ]
        return np.nan_to_num(np.concatenate(parts, axis=1), posinf=0.0, neginf=0.0)


@final
@dataclass(frozen=True)
class Trial:
    """An effect put into a plant at some size, to see what it would do to the readings."""

    effect: Effect
    values: Mapping[str, float]

    @property
    def size(self) -> float:
        """The main parameter, SI."""
        return self.values[self.effect.parameters[0].symbol]


def trials_of(effect: Effect, scale: Scale, most: int = 6) -> list[Trial]:
    """`effect` at its starting values, up to a number of them, spread evenly over them; the typical one first."""
    starts = starts_of(effect, scale)
    chosen = np.unique(np.linspace(0, len(starts) - 1, min(most, len(starts))).astype(int))
    return [Trial(effect, starts[int(n)]) for n in chosen]


def linearise(
    simulator: Simulator,
    problem: Problem,
    structure: Structure,
    step_s: float = _SCREEN_STEP_S,
    *,
    target: Target | None = None,
) -> Linear:
    """Run `structure` and a small move of each of its variables over every reading that is not held out.

    Without a `target`, each reading is predicted from those before it.
    """
    checks = problem.check if target is None else tuple(np.zeros_like(seen) for seen in target.seen())
    target = with_noise(target or problem.everything(), structure.noise)
    jobs = tuple(replace(job, step_s=step_for(structure.plant, step_s)) for job in target.jobs)
    variables = structure.fitted.variables
    sets, widths = moves(structure.plant, variables)
    own_values, scales = values_of(structure.plant, variables), np.array([v.scale for v in variables])
    braked = braked_alike(structure.plant, variables)
    beside = [
        with_slot_values(structure.plant, variables, own_values + sign * _DIFFERENCE * braked).vectors()[0]
        for sign in (1.0, -1.0)
    ]
    sets = np.concatenate([sets[:-1], beside, sets[-1:]])
    _, active = structure.plant.vectors()
    counted = target.seen()
    predicted, last = batch_predictions(
        simulator, sets, np.repeat(active[None], len(sets), axis=0), jobs, counted
    )
    gain = tuple(
        np.sqrt(worth * result.weight[0]) / job.observer.innovation_std
        for worth, job, result in zip(target.evidence, jobs, last, strict=True)
    )
    slopes, innovations = [], []
    along = np.array([v.likeness / v.scale for v in variables]) * own_values
    braked = told_apart((braked / scales)[:, None], along)[:, 0]
    widths = np.append(widths, 2.0 * _DIFFERENCE)
    for job, mask, own, factor in zip(jobs, counted, predicted, gain, strict=True):
        rise = np.nan_to_num((own[:-1:2] - own[1:-1:2]) / widths[:, None] * factor[mask])
        slopes.append(measured_along(told_apart(rise[:-1], along), braked, rise[-1]))
        innovations.append(np.nan_to_num((job.signals.measured[mask] - own[-1]) * factor[mask]))
    return Linear(
        structure=structure,
        jobs=jobs,
        counted=counted,
        innovations=np.concatenate(innovations),
        slopes=np.concatenate(slopes, axis=1) if variables else np.zeros((0, sum(map(np.size, innovations)))),
        tightness=np.array([(v.scale / v.spread) ** 2 for v in variables]),
        run=np.concatenate([np.full(int(mask.sum()), number) for number, mask in enumerate(counted)]),
        time_s=np.concatenate(
            [
                (job.signals.time_s - job.signals.time_s[0])[mask]
                for job, mask in zip(jobs, counted, strict=True)
            ]
        ),
        checks=np.concatenate([check[mask] for check, mask in zip(checks, counted, strict=True)]),
        gain=gain,
        predicted=tuple(result.predicted[0] for result in last),
    )


def signatures(simulator: Simulator, linear: Linear, plant: Plant, trials: Sequence[Trial]) -> FloatArray:
    """What each trial's effect, put into `plant`, adds to the readings of `linear`, shape (trials, readings).

    The sign is that of a prediction: where the effect is real, innovations gain its signature.
    """
    if not trials:
        return np.zeros((0, linear.innovations.size))
    return deviations(simulator, linear, [with_trial(plant, trial) for trial in trials])


def with_trial(plant: Plant, trial: Trial) -> Plant:
    """`plant` with the trial's effect; the inertia of a new load is taken off the body, which has carried it."""
    richer = plant.with_effect(trial.effect.id, trial.values)
    load, body = Slot(trial.effect.id, "load_inertia"), Slot(BASE_OWNER, "inertia")
    if load not in richer.values:
        return richer
    total = plant.values[body]
    share = min(richer.values[load] / total, _LARGEST_LOAD)
    return richer.with_values({body: (1.0 - share) * total, load: share * total})


def deviations(simulator: Simulator, linear: Linear, plants: Sequence[Plant]) -> FloatArray:
    """How far each plant's predictions are from those of `linear`'s structure, shape (plants, readings).

    Plants with states of their own, which may be stiff, are run in exact steps and held against the structure so run.
    """
    coarse_s = linear.jobs[0].step_s
    found = np.zeros((len(plants), linear.innovations.size))
    steps_s = [step_for(plant, coarse_s) for plant in plants]
    for step_s in set(steps_s):
        rows = [n for n, own_s in enumerate(steps_s) if own_s == step_s]
        jobs = [replace(job, step_s=step_s) for job in linear.jobs]
        own = 0.0 if step_s == coarse_s else _run(simulator, linear, [linear.structure.plant], jobs)[0]
        for part in batches(len(rows), samples_of(jobs)):
            some = rows[part]
            found[some] = _run(simulator, linear, [plants[n] for n in some], jobs) - own
    return np.clip(found, -_LARGEST_SIGNATURE, _LARGEST_SIGNATURE)


def _run(simulator: Simulator, linear: Linear, plants: Sequence[Plant], jobs: Sequence[Job]) -> FloatArray:
    vectors = [plant.vectors() for plant in plants]
    values = np.array([values for values, _ in vectors])
    active = np.array([active for _, active in vectors])
    return linear.whitened(simulator.run(values, active, jobs))


def moves(plant: Plant, variables: Sequence[Variable]) -> tuple[FloatArray, FloatArray]:
    """A little more and a little less of each variable in turn, then the plant as it is; the widths in scales."""
    own, _ = plant.vectors()
    index = plant.layout.index
    sets = np.repeat(own[None], 2 * len(variables) + 1, axis=0)
    widths = np.ones(len(variables))
    for number, (variable, value) in enumerate(zip(variables, values_of(plant, variables), strict=True)):
        step = _DIFFERENCE * max(abs(float(value)), 0.1 * variable.scale)
        more, less = min(value + step, variable.upper), max(value - step, variable.lower)
        for slot, ratio in zip(variable.slots, variable.ratios, strict=True):
            sets[2 * number, index[slot]] = more * ratio
            sets[2 * number + 1, index[slot]] = less * ratio
        widths[number] = max(more - less, 1e-300) / variable.scale
    return sets, widths


def with_slot_values(plant: Plant, variables: Sequence[Variable], x: FloatArray) -> Plant:
    """`plant` with its variables at `x`, SI, each within its bounds."""
    new: dict[Slot, float] = {}
    for variable, value in zip(variables, x, strict=True):
        inside = float(np.clip(value, variable.lower, variable.upper))
        new |= {slot: inside * ratio for slot, ratio in zip(variable.slots, variable.ratios, strict=True)}
    return plant.with_values(new)
