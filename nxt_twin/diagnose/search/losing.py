"""Counts that are lost beside a stop: the motor turns further than it reads, and the stop lies further away."""

from __future__ import annotations

from typing import Final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.further import CYCLES, turning_further
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import ANGLE
from nxt_twin.physics.plant import Plant

_LOSSES: Final = (0.025, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4)
"""Shares of lost counts from which a fit begins: beside a stop it moves one by a tenth, between peaks of likelihood."""


def lies_in_angle(effect: Effect) -> bool:
    """Whether the effect has its place or its size in the angle, as a stop, a gap or teeth have."""
    return any(each.dimension == ANGLE or each.name == CYCLES for each in effect.parameters)


def further_away(plant: Plant, effect: Effect) -> list[Plant]:
    """`plant`, and where it loses counts with the stop that is `effect` as much further away as they are fewer.

    A stop's start lies where the readings end.
    """
    lost = [Slot(each.id, each.parameters[0].symbol) for each in plant.effects if each.counted]
    if "stop" not in effect.terms or not lost:
        return [plant]
    limit = Slot(effect.id, effect.parameters[0].symbol)
    return [plant, plant.with_values({limit: plant.values[limit] / (1.0 - plant.values[lost[0]])})]


def losing(fits: Fits, best: Structure, effect: Effect) -> list[Plant]:
    """`best` with the loss of counts that is `effect`, turning further by what is lost: the likeliest for each share.

    No line leads there from a stop where the readings end: it moves only with all else.

    Args:
        fits: of the problem.
        best: with a stop, or another effect that lies in the angle.
        effect: the loss of counts: its share, and the speed from which it sets in.
    """
    share, sets_in = (parameter.symbol for parameter in effect.parameters)
    speeds = sorted({start[sets_in] for start in fits.starts(effect)})
    found = []
    for loss in _LOSSES:
        further = turning_further(best.plant, 1.0 / (1.0 - loss), fits.problem.signals[0].input_kind)
        plants = [further.with_effect(effect.id, {share: loss, sets_in: speed}) for speed in speeds]
        promises = fits.promised(best, plants)
        if promises:
            found.append(plants[max(promises, key=lambda promise: promise[1])[0]])
    return found
