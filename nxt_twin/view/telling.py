"""Which held-out runs to show, the most telling first."""

from __future__ import annotations

import numpy as np

from nxt_twin.diagnose.diagnosis import Diagnosis, HeldOutRun


def most_telling(diagnosis: Diagnosis) -> list[HeldOutRun]:
    """The held-out runs that can be drawn, in the order of what they tell.

    Where the mismatch is explained, first the run on which the improved model gained most; otherwise the one
    on which the best model there is errs most.
    """

    def weight(run: HeldOutRun) -> float:
        gained = run.baseline_rmse - run.improved_rmse
        size = {"explained": gained, "adequate": run.baseline_rmse, "unexplained": run.improved_rmse}
        told = size[diagnosis.verdict]
        return told if np.isfinite(told) else -1.0

    return sorted(filter(_drawable, diagnosis.held_out), key=weight, reverse=True)


def _drawable(run: HeldOutRun) -> bool:
    known = np.isfinite(run.measured) & (run.stale < 0.5)
    return int(np.count_nonzero(known)) > 1 and bool(run.time_s[-1] > run.time_s[0])
