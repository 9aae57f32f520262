"""A problem searched from end to end: what was found, and both plants fitted on all that is not held out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from nxt_twin.diagnose.fitting.everything import fit_everything, roughly_everything
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.explain import Explanation, Progress, explain
from nxt_twin.diagnose.search.settling import settled
from nxt_twin.physics.simulate import Simulator

_AS_GIVEN = replace(SETTLED, iterations=0)


@final
@dataclass(frozen=True)
class Searched:
    """What a search hands on.

    Attributes:
        explanation: what was found.
        refit: the re-fitted baseline at its best, fitted on all that is not held out.
        final: the best structure, fitted on all that is not held out.
    """

    explanation: Explanation
    refit: Structure
    final: Structure


def searched(simulator: Simulator, problem: Problem, progress: Progress) -> Searched:
    """Re-fit the baseline, search for what it lacks, and fit what was found on all that is not held out."""
    progress("re-fitting the baseline")
    fitter = Fitter(simulator, problem)
    baseline = settled_baseline(fitter)
    explanation = explain(fitter, baseline, progress)
    progress("fitting on every reading that is not held out")
    final = fit_everything(fitter, explanation.best.plant, explanation.best.noise)
    refit = best_baseline(fitter, baseline, final)
    if not explanation.found:
        final = refit
    return Searched(explanation, refit, final)


def settled_baseline(fitter: Fitter) -> Structure:
    """The problem's own plant, fitted and settled from a first guess of the noise."""
    problem = fitter.problem
    noise = first_guess(problem.plant, problem.signals, problem.scale.torque)
    return settled(fitter, problem.plant, noise)


def best_baseline(fitter: Fitter, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline that simulates best, so that what was found is not held against a straw man.

    It is fitted under its own noise, under that of the improved plant, and on simulation alone; the parameters as they
    were given stand beside.
    """
    given = fitter.problem.plant
    simulating, drifting = fitter.simulating(baseline.plant, baseline.noise, everything=True)
    fits = [
        roughly_everything(fitter, baseline.plant, baseline.noise, rounds=2),
        roughly_everything(fitter, given, final.noise, rounds=0),
        fitter.checked(simulating, drifting),
        fitter.checked(fitter.fit(given, baseline.noise, _AS_GIVEN)[0], baseline.noise),
    ]
    return min(fits, key=lambda one: fitter.simulated_error(one.plant, final.noise))
