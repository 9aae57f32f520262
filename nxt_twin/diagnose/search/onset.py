"""From which moment on an effect acts, tried where no slope leads: it shows in steps, at each change of a command."""

from __future__ import annotations

from typing import Final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_ONSET: Final = "onset_s"
_REMOVED: Final = "removed_s"
_SHARE: Final = 0.125
"""Of all recordings laid end to end, to either side: the starts of a search lie so far apart."""
_TRIED: Final = 48  # shifts of an onset, spread evenly over both sides


def has_onset(effect: Effect) -> bool:
    """Whether the effect acts from a moment on that has to be found."""
    return any(parameter.name == _ONSET for parameter in effect.parameters)


def at_likeliest_onset(fits: Fits, plant: Plant, effect: Effect, noise: Noise) -> Plant:
    """`plant` with the onset of `effect` at which its readings, fitted and checking ones, are likeliest.

    One that comes on in a checking block shows in no fitted reading, so both count.

    Args:
        fits: of the problem.
        plant: with the effect, fitted.
        effect: with an onset.
        noise: under which readings are weighed.
    """
    slot = _slot(effect)
    ends_s = [one.session_s + float(np.ptp(one.time_s)) for one in fits.problem.signals]
    reach_s = _SHARE * (max(ends_s) - min(one.session_s for one in fits.problem.signals))
    shifts_s = np.linspace(-reach_s, reach_s, _TRIED)
    tried = [plant, *(at_onset(plant, effect, plant.values[slot] + float(shift_s)) for shift_s in shifts_s)]
    tried += [
        removed_at(plant, effect, signals.session_s)
        for signals in fits.problem.signals
        if signals.session_s > plant.values[slot]
    ]
    return tried[int(np.argmin(fits.costs_everywhere(tried, noise)))]


def at_onset(plant: Plant, effect: Effect, onset_s: float) -> Plant:
    """`plant` whose `effect` acts from `onset_s` (s of the session) on, all else as it is."""
    slot = _slot(effect)
    others = {each.symbol: value for each, value in plant.values.items() if each.owner == slot.owner}
    return plant.with_effect(slot.owner, {**others, slot.symbol: max(onset_s, 0.0)})


def removed_at(plant: Plant, effect: Effect, removed_s: float) -> Plant:
    """`plant` whose `effect` ends at `removed_s` (s of the session), all else as it is."""
    return plant.with_values({_slot(effect, _REMOVED): removed_s})


def _slot(effect: Effect, name: str = _ONSET) -> Slot:
    symbol = next(parameter.symbol for parameter in effect.parameters if parameter.name == name)
    return Slot(effect.id, symbol)
