"""Everything that a diagnosis is put together from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.kalman import clean_innovations
from nxt_twin.diagnose.fitting.linear import Linear, linearise, trials_of
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.residuals import Residuals, residuals
from nxt_twin.diagnose.fitting.splits import WINDOW_S
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.calibrate import FalseAlarms, alarms, clean_cases, leftover_threshold
from nxt_twin.diagnose.judging.colour import colour
from nxt_twin.diagnose.judging.detectable import allowed
from nxt_twin.diagnose.judging.doubt import doubts_of, lateness_of, scatter_of
from nxt_twin.diagnose.judging.horizons import (
    Errors,
    beaten_at,
    best_at_every_horizon,
    errors_of,
    floors_of,
    least_wrong,
    nearest_horizon,
)
from nxt_twin.diagnose.judging.intervals import covariance_of
from nxt_twin.diagnose.judging.judge import FreeRun, free_runs, leftover_nats, leftover_nats_of
from nxt_twin.diagnose.judging.onset import placed
from nxt_twin.diagnose.judging.strained import is_one_sided, is_stretched
from nxt_twin.diagnose.judging.verdict import Record, counted_once
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.searched import Searched
from nxt_twin.diagnose.units import Units, units_of
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Simulator

HALF = 0.5
"""Most of an error."""
STRUCTURED_NATS = 15.0
"""Least leftover of a clean recording, nats, below which no synthetic one puts the limit."""

_FLOOR_DOUBT = 1.25
"""By how much an expected error may be too small: floors lie within 0.8 to 1.25 of the true structure's error."""

_CLEARLY_LESS = (
    0.9  # of the baseline's error: a noise that explains as much without the effects proves nothing
)
_CLEAN_LEFTOVERS = 40  # synthetic clean cases at most, whose leftovers set the limit
_FEWEST_LEFTOVERS = 8  # synthetic clean cases at least, however long the recordings are
_MOST_CELLS = 4_000_000  # synthetic readings held at a time, which bounds the memory of an hour's recording


@final
@dataclass(frozen=True)
class LeftOut:
    """An effect that readings call for and no simulation needs; `rms` is the held-out error with it, SI."""

    effect: Effect
    rms: float


@final
@dataclass(frozen=True)
class Evidence:
    """The evidence behind the verdict and all findings.

    Attributes:
        problem, units, explanation: as their types say.
        baseline: the re-fitted baseline at its best, or the given one where that predicts unseen readings better.
        final: the best structure, fitted on everything that is not held out.
        before, after: what the two leave at each reading.
        baseline_runs, final_runs: their free runs over what is held out.
        linear: `final` as a linear regression.
        covariance: of the variables of `final`, robust, SI.
        clean: innovations of synthetic clean recordings, as those of `linear`.
        false_alarms: what the search would have made of the clean cases.
        given_errors, baseline_errors, final_errors: of the three plants on what is held out.
        floors: what a plant that lacks nothing would reach there, at each horizon, SI.
        doubts: how far `final` may err there because fitted readings leave its parameters open, at each horizon, SI.
        record: what the verdict rests on.
        onset_told: effects whose onset fitted readings left open, so that held-out ones had to tell it.
        needless: effects that were found, and dropped since no simulation needs them.
    """

    problem: Problem
    units: Units
    explanation: Explanation
    baseline: Structure
    final: Structure
    before: Residuals
    after: Residuals
    baseline_runs: list[FreeRun]
    final_runs: list[FreeRun]
    linear: Linear
    covariance: FloatArray
    clean: FloatArray
    false_alarms: FalseAlarms
    given_errors: Errors
    baseline_errors: Errors
    final_errors: Errors
    floors: tuple[float, ...]
    doubts: tuple[float, ...]
    record: Record
    onset_told: tuple[Effect, ...] = ()
    needless: tuple[LeftOut, ...] = ()

    @property
    def written(self) -> Plant:
        """The plant that is handed on: the best of improved, re-fitted and given plant on what no fit has seen."""
        return best_at_every_horizon(self._ranked, self.problem.tolerance)

    @property
    def beaten_at(self) -> tuple[float, ...]:
        """The horizons at which another of these plants predicts unseen readings better than the written one, s."""
        return beaten_at(self.written, self._ranked, self.problem.tolerance)

    @property
    def _ranked(self) -> list[tuple[Plant, Errors]]:
        return [
            (self.final.plant, self.final_errors),
            (self.baseline.plant, self.baseline_errors),
            (self.problem.plant, self.given_errors),
        ]


def gather(simulator: Simulator, problem: Problem, searched: Searched, rng: Generator) -> Evidence:
    """Run both structures over everything, and synthetic clean recordings beside them."""
    searched = _no_worse_than_given(simulator, problem, searched)
    placed_final, told = placed(simulator, problem, searched.final)
    searched = replace(searched, final=placed_final)
    baseline, final = searched.refit, searched.final
    before, after = (
        residuals(simulator, structure.plant, problem.everything(), final.noise)
        for structure in (baseline, final)
    )
    linear = linearise(simulator, problem, final)
    clean = clean_cases(linear, rng)
    clean_readings = _clean_residuals(linear, rng)
    clean_left = leftover_nats_of(after, clean_readings)
    limit = leftover_threshold(clean_left, STRUCTURED_NATS)
    trials = [trial for effect in allowed(problem, final.plant) for trial in trials_of(effect, problem.scale)]
    alarmed = alarms(simulator, linear, trials, clean)
    given_errors, baseline_errors, final_errors = (
        errors_of(simulator, problem, plant, final.plant, final.noise)
        for plant in (problem.plant, baseline.plant, final.plant)
    )
    floors = floors_of(problem, final.noise, (given_errors, baseline_errors, final_errors))
    covariance = covariance_of(simulator, problem, linear)
    doubts = doubts_of(simulator, problem, final, covariance)
    late = lateness_of(simulator, problem, final, rng)
    expected = np.sqrt(
        np.square(floors)
        + np.square(doubts)
        + np.square(late)
        + scatter_of(simulator, problem, final.plant) ** 2
    )
    left = leftover_nats(after), limit
    return Evidence(
        problem=problem,
        units=units_of(problem.plant.layout.frame, problem.signals[0]),
        explanation=searched.explanation,
        baseline=baseline,
        final=final,
        before=before,
        after=after,
        baseline_runs=free_runs(simulator, problem, baseline.plant, final.plant, final.noise),
        final_runs=free_runs(simulator, problem, final.plant, final.plant, final.noise),
        linear=linear,
        covariance=covariance,
        clean=linear.left_of(clean),
        false_alarms=FalseAlarms(int(np.sum(alarmed)), len(alarmed)),
        given_errors=given_errors,
        baseline_errors=baseline_errors,
        final_errors=final_errors,
        floors=floors,
        doubts=doubts,
        record=replace(
            _record(problem, searched, left, (baseline_errors, final_errors), floors, expected),
            colour=float(
                colour(after.normalised[None], after.run)[0] / np.median(colour(clean_readings, after.run))
            ),
        ),
        onset_told=told,
    )


def _no_worse_than_given(simulator: Simulator, problem: Problem, searched: Searched) -> Searched:
    """`searched` with the parameters as given for its baseline, where these predict unseen readings better."""
    final = searched.final
    errors = [
        errors_of(simulator, problem, one.plant, final.plant, final.noise)
        for one in (searched.refit, searched.given)
    ]
    if least_wrong(errors, problem.tolerance) == 0:
        return searched
    bare = final is searched.refit
    return replace(searched, refit=searched.given, final=searched.given if bare else final)


def _clean_residuals(linear: Linear, rng: Generator) -> FloatArray:
    """Innovations of clean cases at the readings of `Residuals`: the first thinning of each recording."""
    count = int(np.clip(_MOST_CELLS // max(linear.innovations.size, 1), _FEWEST_LEFTOVERS, _CLEAN_LEFTOVERS))
    seen: set[str] = set()
    parts = []
    for job, predicted in zip(linear.jobs, linear.predicted, strict=True):
        if job.signals.name in seen:
            continue
        seen.add(job.signals.name)
        read = np.isfinite(job.signals.measured) & ~job.start.at
        made = clean_innovations(job, predicted, linear.structure.noise, count, rng)
        parts.append(made[:, read])
    return np.concatenate(parts, axis=1)


def _record(
    problem: Problem,
    searched: Searched,
    left: tuple[float, float],
    errors: tuple[Errors, Errors],
    floors: Sequence[float],
    expected: FloatArray,
) -> Record:
    baseline, final = searched.refit, searched.final
    before, after = errors
    found = searched.explanation.found
    mattering = [n for n in _windows(after) if after.rms[n] > problem.tolerance]
    window = nearest_horizon(after, problem.window_s)
    effects = [effect for effect, _ in found]
    physical = any(not effect.fault for effect in effects)
    weakest, weight = min(found, key=lambda pair: pair[1].total, default=(None, None))
    return Record(
        named=sum(not effect.plain for effect, _ in found),
        found=bool(found),
        left_nats=0.0 if problem.by_windows else left[0],
        left_limit_nats=left[1],
        gained_nats=baseline.fitted.cost - final.fitted.cost,
        torque_before=torque_share(problem, baseline),
        torque_after=torque_share(problem, final),
        run_ratio=final.free_run_rms[0] / max(baseline.free_run_rms[0], 1e-15),
        matters=bool(mattering) and not (found and _at_the_floor(after, before, floors)),
        stalled_share=problem.stalled_share if physical else 0.0,
        surprise=after.rms[window] / max(float(expected[window]), problem.tolerance),
        by_windows=problem.by_windows,
        nearer=after.rms[window] / max(before.rms[window], 1e-15),
        remaining=_largest(problem, after),
        longer=_drift(problem, before, after) if physical else 0.0,
        at_first=_largest(problem, before),
        at_check=baseline.free_run_rms[0] / max(problem.tolerance, 1e-15),
        least_nats=weight.total if weight else 0.0,
        restores=bool(weight and weight.restores),
        of_readings=bool(found) and not physical,
        by_chance=final.noise.slip > 0.0,
        doubts=bool(weakest and "outlier" in weakest.terms),
        worst_ratio=_worst(problem, before, after) if physical else 0.0,
        leaves_most=bool(found) and _leaves_most(problem, before, after, expected),
        strained=is_stretched(problem, final.plant, effects) or is_one_sided(final.plant, effects),
        given_is_a_fit=searched.given_is_a_fit,
    )


def beside_the_others(evidence: Evidence, lesser: Evidence) -> Record:
    """The record of `evidence` against `lesser`, the plant without the weakest effect, in the place of the baseline."""
    problem, before, after = evidence.problem, lesser.final_errors, evidence.final_errors
    window = nearest_horizon(after, problem.window_s)
    return replace(
        counted_once(evidence.record),
        run_ratio=evidence.final.free_run_rms[0] / max(lesser.final.free_run_rms[0], 1e-15),
        at_check=lesser.final.free_run_rms[0] / max(problem.tolerance, 1e-15),
        nearer=after.rms[window] / max(before.rms[window], 1e-15),
        longer=_drift(problem, before, after),
        at_first=_largest(problem, before),
        worst_ratio=_worst(problem, before, after),
    )


def _windows(errors: Errors) -> list[int]:
    """Which horizons are windows of two seconds or shorter."""
    return [n for n, seconds in enumerate(errors.seconds) if seconds <= WINDOW_S]


def _largest(problem: Problem, errors: Errors) -> float:
    """The largest error of windows of two seconds or shorter, over the tolerance."""
    return max((errors.rms[n] for n in _windows(errors)), default=0.0) / max(problem.tolerance, 1e-15)


def _worst(problem: Problem, before: Errors, after: Errors) -> float:
    """The largest error over that of another plant, of windows of two seconds or shorter where it matters."""
    mattering = [n for n in _windows(after) if after.rms[n] > problem.tolerance]
    return max((after.rms[n] / max(before.rms[n], 1e-15) for n in mattering), default=0.0)


def _drift(problem: Problem, before: Errors, after: Errors) -> float:
    """The largest error over that of the baseline, of simulations longer than two seconds where it matters."""
    own = zip(after.seconds, before.rms, after.rms, strict=True)
    longer = [rms / max(other, 1e-15) for s, other, rms in own if s > WINDOW_S and rms > problem.tolerance]
    return max(longer, default=0.0)


def _leaves_most(problem: Problem, before: Errors, after: Errors, expected: FloatArray) -> bool:
    """Whether most of the error of `before` above the `expected` one is left at some horizon, and matters.

    The expected one may be off by `_FLOOR_DOUBT`. Errors that are too small to show in windows add up in longer
    simulations. Where windows err as expected, longer
    ones may err as much as before.
    """
    rows = list(zip(after.seconds, before.rms, after.rms, _FLOOR_DOUBT * expected, strict=True))
    near = all(rms - least <= problem.tolerance for s, _, rms, least in rows if s <= WINDOW_S)
    excused = [other if near and s > WINDOW_S else 0.0 for s, other, _, _ in rows]
    return any(
        rms - max(least, most) > max(HALF * (other - max(least, most)), problem.tolerance)
        for (_, other, rms, least), most in zip(rows, excused, strict=True)
    )


def _at_the_floor(errors: Errors, before: Errors, floors: Sequence[float]) -> bool:
    """Whether windows of two seconds or shorter are off by no more than noise makes them, and by less than `before`."""
    own = zip(errors.seconds, errors.rms, before.rms, floors, strict=True)
    return all(
        rms <= min(floor, _CLEARLY_LESS * other) for seconds, rms, other, floor in own if seconds <= WINDOW_S
    )


def torque_share(problem: Problem, structure: Structure) -> float:
    """The unknown torque that a structure leaves, as a fraction of one that is ordinary for the plant."""
    inertia = structure.plant.values[Slot(BASE_OWNER, "inertia")]
    torque = structure.noise.disturbance_std * inertia
    if problem.by_windows:  # single steps say nothing of it: as much as makes windows err as they do
        torque *= structure.noise.drift
    return torque / problem.scale.torque
