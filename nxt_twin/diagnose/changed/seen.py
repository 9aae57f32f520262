"""What moves and errors of windows say: a size that makes no difference is no effect, a large error is unexplained."""

from __future__ import annotations

import numpy as np

from nxt_twin.diagnose.changed.joint import JointFit, JointFitter
from nxt_twin.diagnose.fitting.noise import reading_floor

LEAST_MOVE = 1.0
"""Of a reading's own error (step/√12): what a change has to move the windows after by, RMS, to be one.

On seed 874 each told change moves them by 1.9 times that or more, where readings are 1 deg apart."""


AS_WELL = 2.0
"""Times another error: what is about as large, of errors that one model may still make where nothing is left to find.

On seed 874 a seventh of the pairs search on by it, and one finds inertia beside a delay."""


def is_as_well(check_rms: tuple[float, ...], alone: float, tolerance: float, as_read: float) -> bool:
    """Whether errors before and after are about that of the side before alone, and alike.

    Rough readings excuse no error that is much larger after than before.

    Args:
        check_rms: of windows that only check, before and after, SI.
        alone: of the side before, by a plant that is fitted to it alone, SI.
        tolerance: error that does not matter, SI.
        as_read: the least error that readings can have, SI.
    """
    before, after = check_rms
    return max(check_rms) <= AS_WELL * max(alone, tolerance) and after <= AS_WELL * max(before, as_read)


def is_seen(fitter: JointFitter, simpler: JointFit, joint: JointFit) -> bool:
    """Whether what `joint` has more moves the windows after by more than a reading's own error.

    Both are at their best numbers, so that what other numbers make up for does not count.
    """
    least = LEAST_MOVE * reading_floor([job.signals for side in fitter.sides for job in side.jobs])
    one, other = (fitter.run(each.model, each.x[None], 1, "everything") for each in (simpler, joint))
    return float(np.sqrt(np.mean((one - other) ** 2))) > least
