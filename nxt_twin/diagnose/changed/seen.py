"""Whether a change moves readings at all: a size that makes no difference over the recordings is no effect."""

from __future__ import annotations

import numpy as np

from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.fitting.noise import reading_floor

LEAST_MOVE = 1.0
"""Of a reading's own error (step/√12): what a change has to move the windows after by, RMS, to be one.

On seed 874 each told change moves them by 1.9 times that or more, where readings are 1 deg apart."""


def is_seen(fitter: JointFitter, simpler: JointFit, joint: JointFit) -> bool:
    """Whether what `joint` has more moves the windows after by more than a reading's own error.

    Both are at their best numbers, so that what other numbers make up for does not count.
    """
    least = LEAST_MOVE * reading_floor([job.signals for side in fitter.sides for job in side.jobs])
    one, other = (fitter.run(each.model, each.x[None], 1, "everything") for each in (simpler, joint))
    return float(np.sqrt(np.mean((one - other) ** 2))) > least
