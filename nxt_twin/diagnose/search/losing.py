"""Counts that are lost: beside a stop, which then lies further away, and where their chance alone shows."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Final

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.further import CYCLES, turning_further
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.parameter import ANGLE
from nxt_twin.physics.plant import Plant

_LOSSES: Final = (0.025, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4)
"""Shares of lost counts from which a fit begins: beside a stop it moves one by a tenth, between peaks of likelihood."""

_CHANCES: Final = (3e-3, 0.01, 0.03, 0.1)
"""Shares whose chance is tried on readings: a drive one way that loses a share has as well another torque constant."""

_QUIETER: Final = (1.0, 0.3, 0.1)
"""Shares of the unknown torque that are tried beside: it has taken in what chance makes of the readings."""

_SMOOTHER: Final = (1.0, 0.7)
"""And of the reading noise, for that reason."""


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


def chance_alone(fits: Fits, best: Structure) -> tuple[float, float, Noise]:
    """By how much likelier readings are where positions also wander as lost counts make them, and under which noise.

    No count is lost on average here, so that no other law can gain as much.

    Returns:
        The gain, nats, the share of counts that are lost, and the noise.
    """
    quantum = max(signals.quantum for signals in fits.problem.signals)
    least_std = quantum / math.sqrt(12.0)
    own = best.noise
    noises = [
        (
            share,
            replace(
                own,
                slip=share * (1.0 - share) * quantum,
                disturbance_std=quieter * own.disturbance_std,
                reading_std=max(smoother * own.reading_std, min(own.reading_std, least_std)),
            ),
        )
        for share, quieter, smoother in itertools.product(_CHANCES, _QUIETER, _SMOOTHER)
    ]
    costs = [float(fits.costs([best.plant], noise)[0]) for _, noise in noises]
    least = min(range(len(costs)), key=costs.__getitem__)
    return float(fits.costs([best.plant], own)[0]) - costs[least], *noises[least]


def wandering(fits: Fits, best: Structure, effect: Effect, share: float, noise: Noise) -> Plant:
    """`best` with a `share` of its counts lost, from the speed that is likeliest under `noise`."""
    loss, sets_in = (parameter.symbol for parameter in effect.parameters)
    speeds = sorted({start[sets_in] for start in fits.starts(effect)})
    plants = [best.plant.with_effect(effect.id, {loss: share, sets_in: speed}) for speed in speeds]
    costs = fits.costs(plants, noise)
    return plants[int(costs.argmin())]
