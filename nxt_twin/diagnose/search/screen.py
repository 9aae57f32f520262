"""Every start of every effect tried in one run each: what it promises, once the rest has been re-fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.losing import further_away
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.parameter import Scale
from nxt_twin.physics.plant import Plant


@final
@dataclass(frozen=True)
class Prospect:
    """An effect added to a plant at one of its starts, the gain that it promises, nats, and stretched by how much."""

    effect: Effect
    plant: Plant
    gain: float
    stretch: float

    def stretched(self, scale: Scale) -> Plant:
        """The plant with the effect's main parameter stretched from where it begins to count, within its bounds."""
        main = self.effect.parameters[0]
        bounds = main.in_frame(self.plant.layout.frame).scaled(scale)
        slot = Slot(self.effect.id, main.symbol)
        nothing = self.plant.values.get(Slot(*main.above), 0.0) if main.above else 0.0
        value = nothing + self.stretch * (self.plant.values[slot] - nothing)
        value = float(np.clip(value, bounds.lower * bounds.si, bounds.upper * bounds.si))
        return self.plant.with_values({slot: value})


def screen(fits: Fits, structure: Structure, effects: Sequence[Effect]) -> list[Prospect]:
    """The gain that each start of each of `effects` promises beside `structure`, likeliest first.

    One run a start gives the signature: the change of all predictions in standard deviations. A score test
    with nuisance parameters projects out all that a re-fit of the structure's own variables could imitate.
    The rest is scaled, since a start has only the order of magnitude.
    """
    tried = [
        (effect, plant)
        for effect in effects
        for start in fits.starts_beside(structure, effect)
        for bare in _with_load(structure.plant.with_effect(effect.id, start), effect)
        for plant in further_away(bare, effect)
    ]
    promises = fits.promised(structure, [plant for _, plant in tried])
    found = [Prospect(*tried[place], gain, stretch) for place, gain, stretch in promises]
    return sorted(found, key=lambda prospect: -prospect.gain)


def _with_load(plant: Plant, effect: Effect) -> list[Plant]:
    """The plant with a new load's inertia taken off the body, which has carried it until now, and beside the body's.

    Behind a soft shaft the body has not carried it: a fit without the load has found the body's inertia alone.
    """
    load = Slot(effect.id, "load_inertia")
    if load not in plant.values:
        return [plant]
    body = Slot(BASE_OWNER, "inertia")
    total = plant.values[body]
    share = plant.values[load] / (plant.values[load] + plant.layout.parameters[body].starts[0])
    split = plant.with_values({body: (1.0 - share) * total, load: share * total})
    return [split, plant.with_values({load: share * total / (1.0 - share)})]
