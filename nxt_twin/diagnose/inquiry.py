"""A problem searched and judged, with a second look wherever the first answer is in doubt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from numpy.random import Generator

from nxt_twin.diagnose.fitting.own_moments import lengths_s
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.judging.colour import COLOURED
from nxt_twin.diagnose.judging.evidence import Evidence, LeftOut, beside_the_others, gather
from nxt_twin.diagnose.judging.horizons import errors_of, nearest_horizon
from nxt_twin.diagnose.judging.judge import overall
from nxt_twin.diagnose.judging.verdict import (
    LIMITS,
    Record,
    counted_once,
    is_idle,
    is_needless,
    is_patchwork,
    is_spoiled,
    is_superfluous,
    may_be_superfluous,
    verdict_of,
)
from nxt_twin.diagnose.progress import Progress
from nxt_twin.diagnose.search.begun import Begun
from nxt_twin.diagnose.search.limits import LIMITS as SEARCH_LIMITS
from nxt_twin.diagnose.search.own_clocks import with_own_clocks
from nxt_twin.diagnose.search.own_moments import with_own_moments
from nxt_twin.diagnose.search.searched import Searched, lessened, searched, searched_anew, with_refused
from nxt_twin.diagnose.telling.estimates import has_loose_size, refitted, surely_moved, vague_effect
from nxt_twin.diagnose.telling.payload import is_a_payload_s
from nxt_twin.diagnose.where.beyond import with_shapes
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.simulate import Simulator

_LOOKS: Final = 2  # for moments of their own, in each recording
_PROMISING: Final = 0.8  # of the error on unseen windows, below which such moments are worth a search


def inquire(simulator: Simulator, problem: Problem, rng: Generator, progress: Progress) -> Evidence:
    """The evidence on one choice of what is held out, with all that its verdict rests on."""
    first = _looked(simulator, problem, rng, progress)
    own = _by_own_moments(simulator, first[0], rng, progress)
    evidence = own or _looked_further(simulator, *first, rng, progress)
    return _with_sizes(with_shapes(simulator, evidence))


def _looked(
    simulator: Simulator,
    problem: Problem,
    rng: Generator,
    progress: Progress,
    known: Sequence[Structure] = (),
) -> tuple[Evidence, bool]:
    """The evidence of a first search, which has the `known` structures at hand, and whether single steps mislead."""
    evidence = _evidence(simulator, problem, rng, progress, known)
    misled = _misled(evidence)
    return evidence if misled else _reconsidered(simulator, evidence, rng, progress), misled


def _looked_further(
    simulator: Simulator, evidence: Evidence, misled: bool, rng: Generator, progress: Progress
) -> Evidence:
    """`evidence`, or what other ways and windows of simulation alone find where it is in doubt."""
    if not misled:
        evidence = _begun_anew(simulator, evidence, rng, progress)
    if misled or _errs_in_colour(evidence.record):
        progress("single steps are coloured: by windows of simulation alone")
        by_windows = _evidence(simulator, replace(evidence.problem, by_windows=True), rng, progress)
        evidence = _nearer(evidence, _reconsidered(simulator, by_windows, rng, progress))
    return evidence


def _by_own_moments(
    simulator: Simulator, evidence: Evidence, rng: Generator, progress: Progress
) -> Evidence | None:
    """What is found where each recording has a moment for itself, if that explains and brings windows nearer.

    A payload may be put on in each anew, or a clock that wanders may stand elsewhere. What is found beside it moves
    these moments: then they are looked for once more. A moment of each recording forgives much: where it explains
    nothing, it says nothing.
    """
    first = evidence
    several = len(lengths_s(evidence.problem)) > 1
    for _ in range(_LOOKS if several else 0):
        if not _asks_for_more(evidence):
            break
        progress("looking for moments that each recording has for itself")
        looks = (with_own_moments, with_own_clocks)
        begun = (look(simulator, evidence.problem, evidence.explanation) for look in looks)
        nearer = (_by_own(simulator, evidence, own, rng, progress) for own in begun if own is not None)
        better = next((one for one in nearer if one is not None), None)
        if better is None:
            break
        evidence = better
    return evidence if evidence is not first and _verdict(evidence) == "explained" else None


def _by_own(
    simulator: Simulator, evidence: Evidence, own: Begun, rng: Generator, progress: Progress
) -> Evidence | None:
    """What is found with recordings that have `begun` so, if that brings windows much nearer than `evidence` does."""
    if not _promises(simulator, evidence, own):
        return None
    more, misled = _looked(simulator, own.problem, rng, progress, [own.structure])
    if not misled and not _is_much_nearer(evidence, more):
        return None
    more = _looked_further(simulator, more, misled, rng, progress)
    return more if _is_much_nearer(evidence, more) else None


def _promises(simulator: Simulator, evidence: Evidence, own: Begun) -> bool:
    """Whether recordings that have `begun` so err less on unseen windows, already before a search with them."""
    plant, window = own.structure.plant, nearest_horizon(evidence.final_errors, evidence.problem.window_s)
    errors = errors_of(simulator, own.problem, plant, plant, own.structure.noise)
    return errors.rms[window] < _PROMISING * evidence.final_errors.rms[window]


def _misled(evidence: Evidence) -> bool:
    """Whether single steps are no evidence, so that windows of simulation alone have to decide.

    They go on in one another, or took more effects than can be missing, or showed a timing fault beside others,
    and leave something unexplained; or they call for several effects that hardly bring a simulation nearer. So do
    effects that leave more than half of the error where steps go on in one another. Readings that are held do so by
    themselves: beside that effect no such fault is taken for misleading. Nor is it beside late stamps that leave less
    than the tolerance: errors leave doubted readings out, so that they tell nothing of how much nearer a plant got.
    """
    record = evidence.record
    if is_idle(record):
        return True
    if any(effect.holds_readings for effect, _ in evidence.explanation.found):
        return False
    late = any("outlier" in effect.terms for effect, _ in evidence.explanation.found)
    no_nearer = record.nearer > LIMITS.confirmed and not (late and record.remaining <= 1.0)
    if record.found and record.colour > COLOURED and no_nearer:
        return True
    if verdict_of(record) != "unexplained":
        return False
    timed = any(effect.equation_of == "timing" for effect, _ in evidence.explanation.found)
    several = record.named > 1
    return record.colour > COLOURED or (timed and several) or is_patchwork(record)


def _nearer(by_steps: Evidence, by_windows: Evidence) -> Evidence:
    """`by_windows`, unless it errs by what matters, and what steps found beyond it brings unseen windows much nearer.

    What steps found explains no more than a part then. Where windows explain what is missing, they decide.
    """
    verdicts = verdict_of(by_steps.record), verdict_of(by_windows.record)
    errs = verdicts[1] == "unexplained" or (verdicts[1] == "adequate" and by_windows.record.remaining > 1.0)
    helped = verdicts[0] == "unexplained" and _found(by_steps) > _found(by_windows)
    return by_steps if errs and helped and _is_much_nearer(by_windows, by_steps) else by_windows


def _found(evidence: Evidence) -> set[str]:
    """The ids of the effects that were found."""
    return {effect.id for effect, _ in evidence.explanation.found}


def _errs_in_colour(record: Record) -> bool:
    """Whether nothing was found by coloured steps, and windows err by what noise does not explain."""
    return not record.found and record.colour > COLOURED and record.remaining > LIMITS.nearly


def _evidence(
    simulator: Simulator,
    problem: Problem,
    rng: Generator,
    progress: Progress,
    known: Sequence[Structure] = (),
) -> Evidence:
    """Search for what the baseline lacks, and gather all that the verdict rests on."""
    found = searched(simulator, problem, progress, known)
    progress("judging on what was held out")
    return _judged(simulator, problem, found, rng)


def _judged(simulator: Simulator, problem: Problem, found: Searched, rng: Generator) -> Evidence:
    """The evidence for what was found, once effects that no reading and no simulation needs are out again."""
    evidence = gather(simulator, problem, found, rng)
    while (vague := vague_effect(evidence)) is not None:
        evidence = _less(simulator, evidence, vague, rng)
    return _without_needless(simulator, _unspoiled(simulator, evidence, rng), rng)


def _reconsidered(simulator: Simulator, evidence: Evidence, rng: Generator, progress: Progress) -> Evidence:
    """`evidence` with a refused effect that explains what is missing, or that helps where nothing was found.

    A search refuses effects by a few seconds that check. What no fit has seen may tell otherwise: then all readings
    have to be explained, and most of what was left. Found effects that leave more than the tolerance get a second look,
    too. So does a plant without any, though open parameters may be all that it lacks.
    """
    verdict, record = verdict_of(evidence.record), evidence.record
    if verdict != "unexplained" and record.remaining <= 1.0:
        return evidence
    progress("looking again at what was refused")
    helps: Evidence | None = None
    for found in with_refused(simulator, evidence.problem, evidence.explanation):
        more = gather(simulator, evidence.problem, found, rng)
        told = verdict_of(more.record) == "explained" and vague_effect(more) is None
        if told and _is_much_nearer(evidence, more):
            return replace(more, needless=evidence.needless)
        helps = helps or replace(more, needless=evidence.needless, record=replace(more.record, helps=True))
    return helps if helps and verdict == "unexplained" and not record.found else evidence


def _begun_anew(simulator: Simulator, evidence: Evidence, rng: Generator, progress: Progress) -> Evidence:
    """`evidence`, or what a search finds from a way that it did not go, where that brings unseen windows much nearer.

    Where more than one thing is missing, the likeliest first step may lead away from all of them.
    """
    if not _asks_for_more(evidence):
        return evidence
    progress("searching from other ways")
    for found in searched_anew(simulator, evidence.problem, evidence.explanation, progress):
        more = _judged(simulator, evidence.problem, found, rng)
        if _is_much_nearer(evidence, more):
            evidence = more
        if _verdict(evidence) == "explained":
            break
    return evidence


def _asks_for_more(evidence: Evidence) -> bool:
    """Whether something is missing, or nothing was found and simulations err by several tolerances."""
    verdict = _verdict(evidence)
    return verdict == "unexplained" or (verdict == "adequate" and evidence.record.remaining > LIMITS.nearly)


def _verdict(evidence: Evidence) -> str:
    """The verdict once it counts how sure the sizes are."""
    return verdict_of(_with_sizes(evidence).record)


def _is_much_nearer(before: Evidence, after: Evidence) -> bool:
    """Whether windows of unseen readings err by half of what they did, or by a third less beside found effects."""
    window = nearest_horizon(after.final_errors, after.problem.window_s)
    asked = SEARCH_LIMITS.nearer if before.record.found else LIMITS.confirmed
    return after.final_errors.rms[window] < asked * before.final_errors.rms[window]


def _without_needless(simulator: Simulator, evidence: Evidence, rng: Generator) -> Evidence:
    """`evidence` without the effects that no simulation needs, the weakest first; each is weighed beside the others."""
    needless: list[LeftOut] = []
    while (idle := _is_needless(evidence)) or may_be_superfluous(counted_once(evidence.record)):
        weakest = _weakest(evidence)
        lesser = _less(simulator, evidence, weakest, rng)
        if not idle and not is_superfluous(beside_the_others(evidence, lesser)):
            break
        needless.append(LeftOut(weakest, overall(evidence.final_runs)))
        evidence = lesser
    return replace(evidence, needless=tuple(needless))


def _is_needless(evidence: Evidence) -> bool:
    """Whether no simulation needs the found effects; it counts, too, how far they moved the given numbers."""
    return bool(evidence.explanation.found) and is_needless(_with_sizes(evidence).record)


def _unspoiled(simulator: Simulator, evidence: Evidence, rng: Generator) -> Evidence:
    """`evidence` without the weakest effects as long as they spoil what the others predict of unseen readings."""
    while is_spoiled(evidence.record):
        lesser = _less(simulator, evidence, _weakest(evidence), rng)
        if lesser.record.nearer >= evidence.record.nearer:
            break
        evidence = lesser
    return evidence


def _weakest(evidence: Evidence) -> Effect:
    """The found effect for which the fewest nats speak."""
    return min(evidence.explanation.found, key=lambda pair: pair[1].total)[0]


def _less(simulator: Simulator, evidence: Evidence, effect: Effect, rng: Generator) -> Evidence:
    """The evidence once a found effect is taken out again."""
    problem = evidence.problem
    return gather(simulator, problem, lessened(simulator, problem, evidence.explanation, effect), rng)


def _with_sizes(evidence: Evidence) -> Evidence:
    """`evidence` with how sure its sizes are, and how far the fit surely moved the given numbers, in its record.

    The inertia that a payload brings is no number of the motor.
    """
    carried = {"inertia_kg_m2"} if is_a_payload_s(evidence) else set()
    moved = surely_moved({key: one for key, one in refitted(evidence).items() if key not in carried})
    return replace(evidence, record=replace(evidence.record, moved=moved, loose=has_loose_size(evidence)))
