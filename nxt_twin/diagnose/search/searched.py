"""A problem searched from end to end: what was found, and both plants fitted on all that is not held out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.fitting.everything import fit_everything, roughly_everything
from nxt_twin.diagnose.fitting.fitter import Fitter
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.explain import Explanation, Progress, explain
from nxt_twin.diagnose.search.settling import settled
from nxt_twin.physics.simulate import Simulator


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
    refit = _best_baseline(fitter, baseline, final) if explanation.found else final
    return Searched(explanation, refit, final)


def settled_baseline(fitter: Fitter) -> Structure:
    """The problem's own plant, fitted and settled from a first guess of the noise."""
    problem = fitter.problem
    noise = first_guess(problem.plant, problem.signals, problem.scale.torque)
    return settled(fitter, problem.plant, noise)


def _best_baseline(fitter: Fitter, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline at its best in free run, so that what was found is not held against a straw man.

    The likeliest noise of a model that lacks much can swallow so much that its parameters mean nothing; under
    the noise of the improved plant they have to carry the motion.
    """
    own = roughly_everything(fitter, baseline.plant, baseline.noise, rounds=2)
    sober = roughly_everything(fitter, fitter.problem.plant, final.noise, rounds=0)
    return min(own, sober, key=lambda structure: structure.free_run_rms[0])
