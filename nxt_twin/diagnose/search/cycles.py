"""A number of cycles a turn, tried whole and half: teeth, poles and slots are whole, and a wave has harmonics."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.parameter import Parameter
from nxt_twin.physics.plant import Plant

_ALIKE: Final = 1e-3  # cycles: a fit that is nearer to a whole number has found it
_MOST_OFF: Final = 0.2
"""Cycles that a fit may be off. Peaks beside the highest lie nearer to it where a motor turns many times."""

_LARGER: Final = (1.5, 4.0)  # times the wave that was found: how large one may be whose harmonic that is
_PHASES: Final = np.linspace(-np.pi, np.pi, 6, endpoint=False)
_LOOSENED: Final = 10.0  # times the unknown torque: under less, no wave fits before the rest has moved


def at_whole_cycles(settled: Settled, trial: Structure, effect: Effect) -> Structure:
    """`trial`, or what settles from the whole number of cycles next to its own, if that is likelier.

    The likelihood of a period has a peak for each turn by which it is off at a recording's end. A fit ends on the
    nearest one, where 12 cycles may be 11.92.
    """
    for parameter in _of_turns(effect):
        slot = Slot(effect.id, parameter.symbol)
        cycles = trial.plant.values[slot]
        if not _ALIKE < abs(cycles - round(cycles)) < _MOST_OFF:
            continue
        whole = settled.settle(trial.plant.with_values({slot: float(round(cycles))}), trial.noise)
        trial = min(trial, whole, key=lambda one: one.fitted_cost)
    return trial


def at_half_the_cycles(fits: Fits, settled: Settled, trial: Structure, effect: Effect) -> Structure:
    """`trial`, or what settles from half its cycles a turn, if that is likelier.

    A fit may end on the second harmonic of a wave that is too large for a linear look to show.
    """
    plants = _halved(trial.plant, effect)
    if not plants:
        return trial
    loosened = replace(trial.noise, disturbance_std=_LOOSENED * trial.noise.disturbance_std)
    costs = fits.costs([trial.plant, *plants], loosened)
    likeliest = int(np.argmin(costs))
    if likeliest == 0:
        return trial
    return min(trial, settled.settle(plants[likeliest - 1], trial.noise), key=lambda one: one.fitted_cost)


def _halved(plant: Plant, effect: Effect) -> list[Plant]:
    """`plant` with a larger wave of half the cycles a turn, at several phases; none where that is below the bounds."""
    phase = next((each for each in effect.parameters if each.name == "phase_deg"), None)
    found = []
    for parameter in _of_turns(effect):
        cycles, size = Slot(effect.id, parameter.symbol), Slot(effect.id, effect.parameters[0].symbol)
        half = 0.5 * plant.values[cycles]
        if phase is None or half < parameter.lower:
            continue
        at = Slot(effect.id, phase.symbol)
        found += [
            plant.with_values({cycles: half, size: larger * plant.values[size], at: float(angle)})
            for larger in _LARGER
            for angle in _PHASES
        ]
    return found


def _of_turns(effect: Effect) -> list[Parameter]:
    return [parameter for parameter in effect.parameters if parameter.name.endswith("per_turn")]
