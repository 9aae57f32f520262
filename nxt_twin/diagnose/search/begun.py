"""Recordings begun with moments of their own: which of several ways to begin them is likelier than one session."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.own_moments import lengths_s
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.explain import Explanation
from nxt_twin.diagnose.search.limits import EFFORT, LIMITS
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.simulate import Simulator


@final
@dataclass(frozen=True)
class Begun:
    """A problem whose recordings have begun with moments of their own, and a plant fitted to it.

    Attributes:
        problem: so begun.
        structure: with `effect`, settled.
        effect: to which these moments belong.
    """

    problem: Problem
    structure: Structure
    effect: Effect


def bases(explanation: Explanation) -> list[Structure]:
    """What such moments are looked for beside: the baseline, and what was found, unless that is many effects."""
    found = explanation.best
    few = len(found.plant.active - explanation.baseline.plant.active) <= EFFORT.beside
    beside = (explanation.baseline, found) if few else (explanation.baseline,)
    return list({one.plant.active: one for one in beside}.values())


def likeliest_begun(
    simulator: Simulator, problem: Problem, best: Structure, looks: Sequence[Begun]
) -> Begun | None:
    """The likeliest of `looks`, where all readings are likelier by far than under `best`; its effect is leant to.

    Readings of a recording that is held out count as well: it has a moment of its own. But only among fits that are as
    good: under a larger noise, what no fit has seen costs less whatever is missing.
    """
    if not looks:
        return None
    lowest = min(_cost(one) for one in (best, *(look.structure for look in looks)))
    near = [one for one in looks if _cost(one.structure) < lowest + LIMITS.rival_nats]
    if not near:
        return None
    leader = min(near, key=lambda one: _cost_of_all(simulator, one, one.structure.noise) + _asked(one))
    asked = LIMITS.own_moment_nats * len(lengths_s(problem))
    before, after = (
        _cost_of_all(simulator, one, leader.structure.noise)
        for one in (replace(leader, problem=problem, structure=best), leader)
    )
    if before - after < asked:
        return None
    leant = {leader.effect.id: 0.0, **problem.leaning}
    return replace(leader, problem=replace(leader.problem, leaning=leant))


def _cost(structure: Structure) -> float:
    """Of the readings that are fitted and of those that check, nats."""
    return structure.fitted_cost + structure.check_cost


def _asked(one: Begun) -> float:
    """What its effects have to gain, nats."""
    return LIMITS.gain_nats * len(one.structure.plant.active)


def _cost_of_all(simulator: Simulator, one: Begun, noise: Noise) -> float:
    """As `_cost`, by drafts under `noise`, with the readings of recordings that are held out as a whole."""
    costs = Fits(simulator, one.problem).costs_of_each([one.structure.plant], noise)
    return one.structure.fitted.prior_cost + sum(float(each[0]) for each in costs.values())
