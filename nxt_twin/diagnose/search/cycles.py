"""A number of cycles a turn, tried whole: teeth, poles and slots are."""

from __future__ import annotations

from typing import Final

from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.layout import Slot

_ALIKE: Final = 1e-3  # cycles: a fit that is nearer to a whole number has found it
_MOST_OFF: Final = 0.2
"""Cycles that a fit may be off. Peaks beside the highest lie nearer to it where a motor turns many times."""


def at_whole_cycles(settled: Settled, trial: Structure, effect: Effect) -> Structure:
    """`trial`, or what settles from the whole number of cycles next to its own, if that is likelier.

    The likelihood of a period has a peak for each turn by which it is off at a recording's end. A fit ends on the
    nearest one, where 12 cycles may be 11.92.
    """
    for parameter in effect.parameters:
        if not parameter.name.endswith("per_turn"):
            continue
        slot = Slot(effect.id, parameter.symbol)
        cycles = trial.plant.values[slot]
        if not _ALIKE < abs(cycles - round(cycles)) < _MOST_OFF:
            continue
        whole = settled.settle(trial.plant.with_values({slot: float(round(cycles))}), trial.noise)
        trial = min(trial, whole, key=lambda one: one.fitted_cost)
    return trial
