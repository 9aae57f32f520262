"""Windows of simulation: a run is corrected for a short spell, and then predicts freely until the next."""

from __future__ import annotations

import numpy as np

from nxt_twin.arrays import BoolArray
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.start import RUN_IN_READINGS, RUN_IN_S

_WORTH_OF_A_WINDOW = (
    4.0  # independent readings: what is simulated errs together from a window's beginning to its end
)
_PULL = 12.0  # of simulated windows while parameters are sought, so that these simulate


def simulated(target: Target, window_s: float) -> Target:
    """The readings of `target`, simulated in windows of `window_s` after a spell that corrects the run.

    The spell brings speed, current and hidden states, such as a load behind play, to where the recording has them.
    Only the first of several thinnings of a recording is simulated.
    """
    parts: list[tuple[int, BoolArray]] = []
    names: set[str] = set()
    for number, job in enumerate(target.jobs):
        if job.signals.name not in names:
            names.add(job.signals.name)
            parts.append((number, _corrected(job.signals, window_s)))
    counted = tuple(target.counted[n] & ~mask for n, mask in parts)
    check = tuple(target.check[n] & ~mask for n, mask in parts)
    jobs = tuple(target.jobs[n] for n, _ in parts)
    seconds = sum(float(job.signals.time_s[-1] - job.signals.time_s[0]) for job in jobs)
    readings = sum(int(a.sum() + b.sum()) for a, b in zip(counted, check, strict=True))
    worth = _WORTH_OF_A_WINDOW * seconds / window_s / max(readings, 1)
    size = len(jobs)
    corrected = tuple(mask for _, mask in parts)
    return Target(jobs, counted, check, (min(1.0, worth),) * size, corrected, (_PULL,) * size)


def _corrected(signals: Signals, window_s: float) -> BoolArray:
    """At which samples the run is corrected."""
    run_in_s = max(RUN_IN_S, RUN_IN_READINGS * signals.interval_s)
    elapsed_s = signals.time_s - signals.time_s[0]
    return np.asarray(np.mod(elapsed_s, run_in_s + window_s) < run_in_s)
