"""The structures that were settled on the way: the best of each set of effects, so that none is fitted twice."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure, is_mechanical
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_BODY = Slot(BASE_OWNER, "inertia")

UNFITTED_NATS = 60.0
"""What a fit may still gain where an effect was taken out, or another start was taken."""


@final
class Settled:
    """What one search has settled, beginning with the re-fitted `baseline` and with what is `known` before."""

    def __init__(self, fits: Fits, baseline: Structure, known: Sequence[Structure] = ()) -> None:
        self._fits = fits
        self._best = {one.plant.active: one for one in (*known, baseline)}
        self._lessened: set[tuple[frozenset[str], str, float]] = set()

    def settle(self, plant: Plant, noise: Noise) -> Structure:
        """Settle, unless that set of effects came out better before."""
        return self.settle_each([(plant, noise)])[0]

    def settle_each(self, starts: Sequence[tuple[Plant, Noise]]) -> list[Structure]:
        """As `settle`, of plants that do not depend on one another."""
        made = self._fits.abreast(lambda start: self._fits.settled(*start), starts)
        return [self._better_known(structure) for structure in made]

    def _better_known(self, structure: Structure) -> Structure:
        """The best that is known of the effects of `structure`, which was settled just now."""
        before = self._best.get(structure.plant.active)
        if before is None or structure.fitted_cost < before.fitted_cost:
            self._best[structure.plant.active] = structure
        return self._best[structure.plant.active]

    def like(self, plant: Plant) -> Structure | None:
        """The settled structure with the effects of `plant`, or None."""
        return self._best.get(plant.active)

    def with_effect(self, bare: Plant, effect: Effect) -> Structure | None:
        """The settled structure with only `effect` added to `bare`, or None."""
        return self._best.get((bare.active - set(effect.supersedes)) | {effect.id})

    def without(self, best: Structure, effect_id: str) -> Structure:
        """`best` less one effect, settled from where `best` lies if that is better than where it was settled before.

        An effect that merely led out of a dead end would else be named for it.
        """
        plant = simpler(best.plant, effect_id, self._fits.problem.plant)
        before, tried = self.like(plant), (best.plant.active, effect_id, best.fitted_cost)
        if before is not None and (tried in self._lessened or self._is_far_behind(plant, best, before)):
            return before
        self._lessened.add(tried)
        return self.settle(plant, best.noise)

    def _is_far_behind(self, plant: Plant, best: Structure, before: Structure) -> bool:
        """Whether `plant` costs so much as it stands that no fit would bring it near `before`.

        Of one with a second body the cost says nothing where a third one went: it is rugged, and falls by thousands.
        """
        gone = best.plant.active - plant.active
        bodies = [is_mechanical(effect) for effect in best.plant.effects]
        if sum(bodies) > 1 and any(is_mechanical(best.plant.layout.effect(each)) for each in gone):
            return False
        return self._fits.settled_cost(plant, best.noise) > before.fitted.cost + UNFITTED_NATS


def simpler(plant: Plant, effect_id: str, baseline: Plant) -> Plant:
    """`plant` without the effect; plain terms that it had replaced come back, and the body carries its load."""
    effect = plant.layout.effect(effect_id)
    bare = plant.without([effect_id])
    carried = plant.values.get(Slot(effect_id, "load_inertia"), 0.0)
    if carried > 0.0:
        bare = bare.with_values({_BODY: bare.values[_BODY] + carried})
    mean = sum(plant.values[Slot(effect_id, p.symbol)] for p in effect.parameters) / len(effect.parameters)
    for plain in effect.supersedes:
        symbol = plant.layout.effect(plain).parameters[0].symbol
        bare = bare.with_effect(plain, {symbol: baseline.values.get(Slot(plain, symbol), mean)})
    return bare
