"""Which held-out runs to show, the most telling first."""

from __future__ import annotations

import numpy as np

from nxt_twin.diagnose.diagnosis import Diagnosis, HeldOutRun


def most_telling(diagnosis: Diagnosis) -> list[HeldOutRun]:
    """The held-out runs that can be drawn, in the order of what they tell.

    If the mismatch is explained, the run with the largest gain of the improved model comes first. Otherwise the run
    with the largest error of the best model comes first.
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
