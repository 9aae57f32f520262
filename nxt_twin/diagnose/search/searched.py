"""A problem searched from end to end: what was found, and both plants fitted on all that is not held out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.explain import Explanation, explain, explain_anew
from nxt_twin.diagnose.search.helping import helping
from nxt_twin.diagnose.search.limits import EFFORT
from nxt_twin.diagnose.search.notable import is_notable
from nxt_twin.diagnose.search.settled import simpler
from nxt_twin.diagnose.search.weight import weigh
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.simulate import Simulator

_AS_GOOD = 2.0  # with an effect of next to no size
_CLEARLY = 1.02  # by factor: an error that is larger by more is no luck


@final
@dataclass(frozen=True)
class Searched:
    """The results of a search.

    Attributes:
        explanation: what was found.
        refit: the re-fitted baseline at its best, fitted on all that is not held out.
        given: the baseline with its parameters as they came.
        final: the best structure, fitted on all that is not held out; it may hold effects too small for a name.
        given_is_a_fit: whether the given numbers simulate fitted readings clearly nearer than re-fitted ones do.
    """

    explanation: Explanation
    refit: Structure
    given: Structure
    final: Structure
    given_is_a_fit: bool = False


def searched(
    simulator: Simulator, problem: Problem, progress: Progress, known: Sequence[Structure] = ()
) -> Searched:
    """Re-fit the baseline, search for what it lacks, and fit what was found on all that is not held out.

    Structures that are `known` before are at hand in the search.
    """
    progress("re-fitting the baseline")
    fits = Fits(simulator, problem)
    baseline = fits.settled_baseline()
    explanation = explain(fits, baseline, progress, known)
    progress("fitting on every reading that is not held out")
    return _fitted(fits, explanation)


def searched_anew(
    simulator: Simulator, problem: Problem, explanation: Explanation, progress: Progress
) -> Iterator[Searched]:
    """Each end, likelier than the last, of a search from the ways that `explanation` did not go."""
    fits = Fits(simulator, problem)
    ways, likeliest = explanation.untaken[: EFFORT.anew], explanation
    for way in ways:
        other = explain_anew(fits, likeliest, _rested(fits, way), progress)
        if other is not None and other.best.plant.active != likeliest.best.plant.active:
            likeliest = other
            yield _fitted(fits, other)


def _rested(fits: Fits, way: Structure) -> Structure:
    """`way`, or what it comes to from a small unknown torque where that is likelier: a large one forgives too much."""
    sober = replace(way.noise, disturbance_std=EFFORT.quiet * way.noise.disturbance_std)
    return min(way, fits.settled(way.plant, sober), key=lambda one: one.fitted_cost + one.check_cost)


def lessened(simulator: Simulator, problem: Problem, explanation: Explanation, effect: Effect) -> Searched:
    """`explanation` less one effect, with all that was found besides fitted again."""
    fits = Fits(simulator, problem)
    return _fitted(fits, _without(fits, explanation, effect))


def with_refused(simulator: Simulator, problem: Problem, explanation: Explanation) -> Iterator[Searched]:
    """`explanation` with each effect that was refused and helps, the most helpful first, unless it proves too small."""
    fits = Fits(simulator, problem)
    for more in helping(explanation, problem.plant):
        found = _fitted(fits, more)
        if len(found.explanation.found) == len(more.found):
            yield found


def _fitted(fits: Fits, explanation: Explanation) -> Searched:
    """Both plants fitted on everything that is not held out; what turns out too small for a name goes."""
    final = fits.everything(explanation.best.plant, explanation.best.noise)
    while faint := _faint(fits, explanation, final):
        lesser = _without(fits, explanation, faint)
        refitted = fits.everything(lesser.best.plant, final.noise)
        if _simulates_worse(fits, final, refitted):
            break
        explanation, final = lesser, refitted
    given = fits.as_given(explanation.baseline.noise)
    if not explanation.found and not explanation.unnamed:
        refit = fits.likely_baseline(explanation.baseline, final)
        return Searched(explanation, refit, given, refit)
    refit = fits.best_baseline(explanation.baseline, final)
    return Searched(explanation, refit, given, final, _is_a_fit(fits, explanation.baseline, refit))


def _is_a_fit(fits: Fits, likely: Structure, refit: Structure) -> bool:
    """Whether the given numbers come as near as the best baseline, and clearly nearer than the `likely` one."""
    plants = (fits.problem.plant, refit.plant, likely.plant)
    given, best, other = (fits.simulated_error(plant, likely.noise) for plant in plants)
    return given < _CLEARLY * best and other > _CLEARLY * given


def _faint(fits: Fits, explanation: Explanation, final: Structure) -> Effect | None:
    """A found effect that is too small for a name once all readings have been fitted."""
    scale = fits.problem.scale
    small = (e for e, _ in reversed(explanation.found) if not is_notable(final.plant, e, scale))
    return next((e for e in small if e.id not in explanation.loud), None)


def _simulates_worse(fits: Fits, richer: Structure, simpler: Structure) -> bool:
    """Whether `simpler` simulates what was fitted worse, and by more than does not matter."""
    after, before = (fits.simulated_error(one.plant, richer.noise) for one in (simpler, richer))
    return after > max(_AS_GOOD * before, fits.problem.tolerance)


def _without(fits: Fits, explanation: Explanation, faint: Effect) -> Explanation:
    """The explanation less one effect, in whose place others may be looked at again."""
    plant = simpler(explanation.best.plant, faint.id, fits.problem.plant)
    best = fits.settled(plant, explanation.best.noise)
    kept = tuple(one for one in explanation.found if one[0] is not faint)
    instead = tuple(
        (rival.effect, weigh(best, rival.structure), rival.structure)
        for rival in explanation.rivals[faint.id]
    )
    return replace(
        explanation,
        best=best,
        found=kept,
        rivals={effect.id: explanation.rivals[effect.id] for effect, _ in kept},
        refused=(*instead, *explanation.refused),
    )
