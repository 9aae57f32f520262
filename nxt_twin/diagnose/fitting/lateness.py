"""By how much the readings that a plant doubts were late."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.fitting.doubted import is_doubted
from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.physics.layout import Slot
from nxt_twin.physics.plant import Plant

_MOSTLY = 0.5  # of the doubted readings: where more are at a stop, it is the stop's law that is doubted
_AT_A_STOP_RAD = 0.25
"""How near a stop a bounce takes place: of 286 readings that a foreign motor had doubted, 252 were that near."""


def lateness_s(fitter: Fitter, structure: Structure) -> float:
    """The mean age of the readings that `structure` doubts, s, each weighed by the speed; 0 where it doubts none.

    An age is what the reading lacks, over the speed. It is negative where readings run ahead of the plant. None is late
    where most of the doubted ones are at a stop: no two stops are hard in one way.
    """
    tuned = fitter.tuned(structure.noise, SETTLED.step_for(structure.plant)).predicting()
    lacking = passed = 0.0
    every = stopped = 0
    for job in tuned.jobs:
        trace = fitter.simulator.trace(structure.plant, job)
        measured, speed = job.signals.measured, trace["speed"]
        doubted = np.isfinite(measured) & ~job.start.at & is_doubted(structure.plant, trace["weight"])
        lacking += float(np.sum(((trace["predicted"] - measured) * np.sign(speed))[doubted]))
        passed += float(np.sum(np.abs(speed[doubted])))
        every += int(np.sum(doubted))
        stopped += int(np.sum(doubted & _at_a_stop(structure.plant, trace["predicted"])))
    return lacking / max(passed, 1e-12) if stopped <= _MOSTLY * every else 0.0


def _at_a_stop(plant: Plant, angle: FloatArray) -> BoolArray:
    """Which samples are near a stop that the plant has, shape (samples,)."""
    limit = plant.values.get(Slot("end_stop", "limit"))
    if limit is None or plant.layout.frame == "linear":
        return np.zeros(angle.size, dtype=bool)
    return np.asarray(np.abs(angle - limit) < _AT_A_STOP_RAD)
