"""Play in the place of a shaft that twists, from where that has brought the masses.

Both put a second body behind something that gives. The likelihood of play is rugged. From a motor of one body a fit
rarely reaches it, and a shaft that twists takes its place. From there it does, once the masses are parted.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant

_SHAFT: Final = "shaft_compliance"
_PLAY: Final = "backlash"
_OF_THE_LOAD: Final = ("load_inertia", "load_friction_share")
_GAP: Final = "gap"
_WIDTHS: Final = 10  # gaps that are tried, evenly in their logarithm
_NARROWEST, _WIDEST = 0.5, 6.0  # of the narrowest and of the widest ordinary gap
_TOLD_APART: Final = 30.0  # times the unknown torque: under less, no gap fits before the rest has moved
_LOOSENED: Final = (1.0, 10.0)  # times the unknown torque, from which play is settled


def may_hide_play(effect: Effect, other: Effect) -> bool:
    """Whether `effect` is a shaft that twists and `other` is play."""
    return (effect.id, other.id) == (_SHAFT, _PLAY)


def play_behind(fits: Fits, best: Structure, other: Effect) -> list[tuple[Plant, Noise]]:
    """Starts of play, which `other` is, in the place of the shaft that twists in `best`."""
    bare = best.plant.without([_SHAFT])
    load = {each: best.plant.values[Slot(_SHAFT, each)] for each in _OF_THE_LOAD}
    ordinary = [start[_GAP] for start in fits.starts(other)]
    widths = np.geomspace(_NARROWEST * min(ordinary), _WIDEST * max(ordinary), _WIDTHS)
    plants = [bare.with_effect(_PLAY, {**load, _GAP: float(width)}) for width in widths]
    costs = fits.costs(plants, _loosened(best.noise, _TOLD_APART))
    likeliest = plants[int(np.argmin(costs))]
    return [(likeliest, _loosened(best.noise, factor)) for factor in _LOOSENED]


def _loosened(noise: Noise, factor: float) -> Noise:
    return replace(noise, disturbance_std=factor * noise.disturbance_std)
