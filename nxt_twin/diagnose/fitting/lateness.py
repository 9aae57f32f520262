"""By how much the readings that a plant doubts were late."""

from __future__ import annotations

import numpy as np

from nxt_twin.diagnose.fitting.fitter import SETTLED, Fitter
from nxt_twin.diagnose.fitting.structure import Structure

_DOUBTED = 0.5  # belief in a reading


def lateness_s(fitter: Fitter, structure: Structure) -> float:
    """The mean age of the readings that `structure` doubts, s, each weighed by the speed; 0 where it doubts none.

    An age is what the reading lacks, over the speed. It is negative where readings run ahead of the plant.
    """
    tuned = fitter.tuned(structure.noise, SETTLED.step_for(structure.plant)).predicting()
    lacking = passed = 0.0
    for job in tuned.jobs:
        trace = fitter.simulator.trace(structure.plant, job)
        measured, speed = job.signals.measured, trace["speed"]
        doubted = np.isfinite(measured) & ~job.start.at & (trace["weight"] < _DOUBTED)
        lacking += float(np.sum(((trace["predicted"] - measured) * np.sign(speed))[doubted]))
        passed += float(np.sum(np.abs(speed[doubted])))
    return lacking / max(passed, 1e-12)
