"""Everything that a diagnosis is put together from, and how the verdict follows from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.random import Generator

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import Verdict
from nxt_twin.diagnose.fitting.kalman import clean_innovations
from nxt_twin.diagnose.fitting.linear import Linear, linearise, trials_of
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.residuals import Residuals, residuals
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.calibrate import FalseAlarms, alarms, clean_cases, leftover_threshold
from nxt_twin.diagnose.judging.detectable import allowed
from nxt_twin.diagnose.judging.intervals import robust_covariance
from nxt_twin.diagnose.judging.judge import FreeRun, free_runs, leftover_nats, leftover_nats_of, noise_floor
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.searched import Searched
from nxt_twin.diagnose.units import Units, units_of
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.simulate import Simulator

STRUCTURED_NATS = 15.0
STRUCTURED_TORQUE = 2e-3
LARGE_TORQUE = 3e-2
MOST_LEFT = 0.1
FAR_OFF = 4.0
UNSETTLED = 3.5e-3
HARDLY = 0.15
MOST_NAMED = 3
"""When what is left is more than noise: a flexible function of the state foretells it by so many nats, more than in
clean recordings made up like these, and it is at least the second, or it is the third whatever foretells it; as
fractions of a torque ordinary for the plant. Where effects were found, it must also be the fourth of all that there
was to explain. Where none was found, free runs over readings that only check must not be the fifth times as far off
as noise alone. Where something was found, the unknown torque that it leaves, times the share that it leaves of the
error of free runs, must not be above the sixth unless that share is below the seventh: a term that an unknown effect
happens to resemble does not carry the motion. Where more effects than the last were needed, beside those that plant
files mostly state, they are pieces of something else."""

_CLEAN_LEFTOVERS = 40
_FEWEST_LEFTOVERS = 8
_MOST_CELLS = 4_000_000  # made-up readings held at a time, which bounds the memory of an hour's recording


@final
@dataclass(frozen=True)
class Evidence:
    """What the verdict and all findings rest on.

    Attributes:
        problem, units, explanation: as their types say.
        baseline: the re-fitted baseline at its best.
        final: the best structure, fitted on everything that is not held out.
        before, after: what the two leave at each reading.
        baseline_runs, final_runs: their free runs over what is held out.
        linear: `final` as a linear regression.
        covariance: of the variables of `final`, robust, SI.
        clean: innovations of made-up clean recordings, as those of `linear`.
        leftover_limit: nats that a clean case leaves at most.
        false_alarms: what the search would have made of the clean cases.
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
    leftover_limit: float
    false_alarms: FalseAlarms


def gather(simulator: Simulator, problem: Problem, searched: Searched, rng: Generator) -> Evidence:
    """Run both structures over everything, and made-up clean recordings beside them."""
    baseline, final = searched.refit, searched.final
    before, after = (
        residuals(simulator, structure.plant, problem.everything(), final.noise)
        for structure in (baseline, final)
    )
    linear = linearise(simulator, problem, final)
    clean = clean_cases(linear, rng)
    clean_left = leftover_nats_of(after, _clean_residuals(linear, rng))
    limit = leftover_threshold(clean_left, STRUCTURED_NATS)
    trials = [trial for effect in allowed(problem, final.plant) for trial in trials_of(effect, problem.scale)]
    alarmed = alarms(simulator, linear, trials, clean)
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
        covariance=robust_covariance(simulator, linear),
        clean=linear.left_of(clean),
        leftover_limit=limit,
        false_alarms=FalseAlarms(int(np.sum(alarmed)), len(alarmed)),
    )


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


def verdict_of(evidence: Evidence) -> Verdict:
    """Adequate, explained or unexplained, by what is left beside what was found."""
    left = leftover_nats(evidence.after)
    before, after = (torque_share(evidence.problem, s) for s in (evidence.baseline, evidence.final))
    structured = left > evidence.leftover_limit and after > STRUCTURED_TORQUE
    large = after > LARGE_TORQUE
    if not evidence.explanation.found:
        floor = noise_floor(evidence.problem, evidence.final.noise)
        runs_away = evidence.final.free_run_rms[0] > FAR_OFF * floor
        return "unexplained" if structured or large or runs_away else "adequate"
    gained = evidence.baseline.fitted.cost - evidence.final.fitted.cost
    mostly_left = structured and left > MOST_LEFT * (left + gained)
    share = _free_run_ratio(evidence)
    hardly = share > HARDLY and share * after > UNSETTLED
    still_large = large and after > 0.5 * before
    return "unexplained" if mostly_left or hardly or still_large or is_patchwork(evidence) else "explained"


def is_patchwork(evidence: Evidence) -> bool:
    """Whether it took more effects than are likely to be missing at once, so that they stand for something else."""
    return sum(not effect.plain for effect, _ in evidence.explanation.found) > MOST_NAMED


def _free_run_ratio(evidence: Evidence) -> float:
    """The error of free runs over checking readings, with what was found over without."""
    before, after = evidence.baseline.free_run_rms[0], evidence.final.free_run_rms[0]
    return after / max(before, 1e-15)


def torque_share(problem: Problem, structure: Structure) -> float:
    """The unknown torque that a structure leaves, as a fraction of one that is ordinary for the plant."""
    inertia = structure.plant.values[Slot(BASE_OWNER, "inertia")]
    return structure.noise.disturbance_std * inertia / problem.scale.torque
