"""Candidate effects added to a structure and fitted roughly: enough to rank them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Draft, Structure
from nxt_twin.diagnose.search.screen import Prospect, screen
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

STARTS_FOLLOWED = 3  # starts of one effect that are fitted, those that promise most
START_ITERATIONS = 2  # steps of a rough fit from each start, to find the best one
SLOW_ITERATIONS = 10  # steps of a rough fit of an effect with states of its own
LOSS_ITERATIONS = 7  # steps of a rough fit of lost counts beside a stop, which has to move as well

_LEAST_PROMISE_NATS = 2.0  # nats: a start that promises no more, by a score test, is left out
_STARTS_SHARE = 0.5  # of the promise of the best start, without which another is not followed
_ALIKE_NATS = 0.1  # nats: starts within this distance of the best promise are alike to fitted readings
_MANY_ALIKE = 2  # starts alike, the best among them, from which checking readings order them
_QUICK_ITERATIONS = 4  # steps of a rough fit of an effect without states


@final
@dataclass(frozen=True)
class _Known:
    """What was tried with one structure: the starts of each effect, likeliest first, and its draft, by its id."""

    structure: Structure
    prospects: dict[str, list[Prospect]] = field(default_factory=dict)
    drafts: dict[str, Draft] = field(default_factory=dict)


@final
class Drafts:
    """Drafts of one problem; what was made for a structure once is not made again."""

    def __init__(self, fits: Fits) -> None:
        self._fits = fits
        self._known: list[_Known] = []

    def of(
        self, structure: Structure, effects: list[Effect], most: int, least_nats: float = 0.0
    ) -> list[tuple[Effect, Draft]]:
        """The likeliest of `effects`, up to a number of them, added to `structure` and fitted roughly; best first.

        Those that promise less than `least_nats` are left out.
        """
        least = max(least_nats, _LEAST_PROMISE_NATS)
        prospects = self.prospects(structure, effects)
        likely = [e for e in effects if e.id in prospects and prospects[e.id][0].gain > least]
        likely.sort(key=lambda e: -prospects[e.id][0].gain)
        drafts, noise = self._of(structure).drafts, structure.noise
        missing = [effect.id for effect in likely[:most] if effect.id not in drafts]
        made_now = self._fits.abreast(
            lambda one: self._draft(self._ordered(prospects[one], noise), noise), missing
        )
        drafts.update(zip(missing, made_now, strict=True))
        made = [(effect, drafts[effect.id]) for effect in likely[:most]]
        return sorted(made, key=lambda item: item[1].cost)

    def prospects(self, structure: Structure, effects: list[Effect]) -> dict[str, list[Prospect]]:
        """The starts of each of `effects` beside `structure`, by the effect's id, likeliest first."""
        known = self._of(structure).prospects
        for prospect in screen(self._fits, structure, [e for e in effects if e.id not in known]):
            known.setdefault(prospect.effect.id, []).append(prospect)
        return known

    def _of(self, structure: Structure) -> _Known:
        for known in self._known:
            if known.structure is structure:
                return known
        self._known.append(_Known(structure))
        return self._known[-1]

    def _draft(self, prospects: list[Prospect], noise: Noise) -> Draft:
        """One effect from the starts that promise most: each followed for a step or two, the best of them further."""
        further = SLOW_ITERATIONS if prospects[0].effect.states else _QUICK_ITERATIONS
        enough = _STARTS_SHARE * prospects[0].gain
        plants = self._nearer([p for p in prospects[:STARTS_FOLLOWED] if p.gain > enough], noise)
        if len(plants) > 1:
            trials = self._fits.abreast(
                lambda plant: self._fits.draft(plant, noise, iterations=START_ITERATIONS), plants
            )
            best = min(trials, key=lambda trial: trial.fitted.cost + trial.fitted.prior_cost)
            plants = [best.fitted.plant]
        # Slopes that have followed a start's steps promise too little here: measured anew, a fit goes further.
        return self._fits.draft(plants[0], noise, iterations=further)

    def _ordered(self, prospects: list[Prospect], noise: Noise) -> list[Prospect]:
        """Those that promise anything; of starts that the fitted readings cannot tell apart the best to check first.

        A payload put on between two recordings is as likely at either end of one that only checks.
        """
        promising = [p for p in prospects if p.gain > _LEAST_PROMISE_NATS]
        alike = [p for p in promising if p.gain > prospects[0].gain - _ALIKE_NATS]
        if len(alike) < _MANY_ALIKE:
            return promising
        costs = self._fits.check_costs([p.plant for p in alike], noise)
        return [alike[n] for n in np.argsort(costs)] + promising[len(alike) :]

    def _nearer(self, prospects: list[Prospect], noise: Noise) -> list[Plant]:
        """Each start as it is or stretched by what it promises the more for, whichever is likelier."""
        scale = self._fits.problem.scale
        pairs = [(prospect.plant, prospect.stretched(scale)) for prospect in prospects]
        costs = self._fits.costs([plant for pair in pairs for plant in pair], noise)
        return [pair[int(np.argmin(costs[2 * n : 2 * n + 2]))] for n, pair in enumerate(pairs)]
