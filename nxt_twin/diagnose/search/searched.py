"""A problem searched from end to end: what was found, and both plants fitted on all that is not held out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from nxt_twin.diagnose.fitting.everything import fit_everything, roughly_everything
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.noise import first_guess
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.explain import Explanation, explain
from nxt_twin.diagnose.search.notable import is_notable
from nxt_twin.diagnose.search.settled import simpler
from nxt_twin.diagnose.search.settling import settled
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.simulate import Simulator

_AS_GOOD = 2.0  # with an effect of next to no size
_AS_GIVEN = replace(SETTLED, iterations=0)


@final
@dataclass(frozen=True)
class Searched:
    """The results of a search.

    Attributes:
        explanation: what was found.
        refit: the re-fitted baseline at its best, fitted on all that is not held out.
        given: the baseline with its parameters as they came.
        final: the best structure, fitted on all that is not held out.
    """

    explanation: Explanation
    refit: Structure
    given: Structure
    final: Structure


def searched(simulator: Simulator, problem: Problem, progress: Progress) -> Searched:
    """Re-fit the baseline, search for what it lacks, and fit what was found on all that is not held out."""
    progress("re-fitting the baseline")
    fitter = Fitter(simulator, problem)
    baseline = settled_baseline(fitter)
    explanation = explain(fitter, baseline, progress)
    progress("fitting on every reading that is not held out")
    return _fitted(fitter, explanation)


def lessened(simulator: Simulator, problem: Problem, found: Searched, effect: Effect) -> Searched:
    """`found` less one effect, with all that was found besides fitted again."""
    fitter = Fitter(simulator, problem)
    return _fitted(fitter, _without(fitter, found.explanation, effect))


def _fitted(fitter: Fitter, explanation: Explanation) -> Searched:
    """Both plants fitted on everything that is not held out; what turns out too small for a name goes."""
    final = fit_everything(fitter, explanation.best.plant, explanation.best.noise)
    while faint := _faint(fitter, explanation, final):
        lesser = _without(fitter, explanation, faint)
        refitted = fit_everything(fitter, lesser.best.plant, final.noise)
        if _simulates_worse(fitter, final, refitted):
            break
        explanation, final = lesser, refitted
    refit = best_baseline(fitter, explanation.baseline, final)
    given = as_given(fitter, explanation.baseline.noise)
    return Searched(explanation, refit, given, final if explanation.found else refit)


def _faint(fitter: Fitter, explanation: Explanation, final: Structure) -> Effect | None:
    """A found effect that is too small for a name once all readings have been fitted."""
    scale = fitter.problem.scale
    return next((e for e, _ in reversed(explanation.found) if not is_notable(final.plant, e, scale)), None)


def _simulates_worse(fitter: Fitter, richer: Structure, simpler: Structure) -> bool:
    """Whether `simpler` simulates what was fitted worse, and by more than does not matter."""
    after, before = (fitter.simulated_error(one.plant, richer.noise) for one in (simpler, richer))
    return after > max(_AS_GOOD * before, fitter.problem.tolerance)


def _without(fitter: Fitter, explanation: Explanation, faint: Effect) -> Explanation:
    """The explanation less one effect."""
    plant = simpler(explanation.best.plant, faint.id, fitter.problem.plant)
    kept = tuple(one for one in explanation.found if one[0] is not faint)
    return replace(
        explanation,
        best=settled(fitter, plant, explanation.best.noise),
        found=kept,
        rivals={effect.id: explanation.rivals[effect.id] for effect, _ in kept},
    )


def settled_baseline(fitter: Fitter) -> Structure:
    """The problem's own plant, fitted and settled from a first guess of the noise."""
    problem = fitter.problem
    noise = first_guess(problem.plant, problem.signals, problem.scale.torque)
    return settled(fitter, problem.plant, noise)


def as_given(fitter: Fitter, noise: Noise) -> Structure:
    """The problem's own plant with its parameters as they came."""
    return fitter.checked(fitter.fit(fitter.problem.plant, noise, _AS_GIVEN)[0], noise)


def best_baseline(fitter: Fitter, baseline: Structure, final: Structure) -> Structure:
    """The re-fitted baseline that simulates best, so that what was found is not held against a straw man.

    It is fitted under its own noise, under that of the improved plant, and on simulation alone; the parameters as they
    were given stand beside.
    """
    simulating, drifting = fitter.simulating(baseline.plant, baseline.noise, everything=True)
    fits = [
        roughly_everything(fitter, baseline.plant, baseline.noise, rounds=2),
        roughly_everything(fitter, fitter.problem.plant, final.noise, rounds=0),
        fitter.checked(simulating, drifting),
        as_given(fitter, baseline.noise),
    ]
    return min(fits, key=lambda one: fitter.simulated_error(one.plant, final.noise))
