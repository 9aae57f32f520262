"""Held-out recordings that let the motor run without current, or on a floating bridge, where no fitted one does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.diagnose.diagnosis import Fit
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.units import units_of
from nxt_twin.physics.modes import MODE_COAST, MODE_FLOAT
from nxt_twin.physics.signals import Signals

_CLEARLY_MATTERS = 2.0  # times the error that does not matter
_BRIEF_S = 0.5  # s: a shorter coast-down in a held-out recording is not told


@final
@dataclass(frozen=True)
class RunOut:
    """For how many seconds a held-out recording is in each such mode."""

    recording: str
    seconds: Mapping[int, float]


def unfitted_run_outs(problem: Problem, fit: Fit) -> list[RunOut]:
    """Those, where free runs are off by well more than what does not matter."""
    factor = units_of(problem.plant.layout.frame, problem.signals[0]).reading_factor
    if fit.improved <= _CLEARLY_MATTERS * factor * problem.tolerance:
        return []
    fitted = {mode for signals in problem.signals for mode in _modes_s(signals)}
    found = []
    for part in problem.held_out:
        lasts_s = _modes_s(part.signals)
        seconds = {
            mode: lasts_s[mode] for mode in (MODE_COAST, MODE_FLOAT) if mode in lasts_s.keys() - fitted
        }
        if sum(seconds.values()) >= _BRIEF_S:
            found.append(RunOut(part.signals.name, seconds))
    return found


def _modes_s(signals: Signals) -> dict[int, float]:
    """For how long each drive mode is in force while readings are taken, s."""
    ends_s = np.append(signals.command_time_s[1:], np.inf)
    first_s, last_s = signals.time_s[0], signals.time_s[-1]
    lasts_s = np.clip(ends_s, first_s, last_s) - np.clip(signals.command_time_s, first_s, last_s)
    return {
        mode: float(lasts_s[signals.command_mode == mode].sum())
        for mode in np.unique(signals.command_mode).tolist()
    }
