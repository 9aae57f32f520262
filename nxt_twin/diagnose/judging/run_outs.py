"""Held-out recordings that let the motor run without current, or on a floating bridge, where no fitted one does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from nxt_twin.diagnose.diagnosis import Fit
from nxt_twin.diagnose.fitting.parted import run_outs_s
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.units import units_of

_CLEARLY_MATTERS = 2.0  # times the error that does not matter


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
    seconds = [(part.signals.name, run_outs_s(problem.signals, part.signals)) for part in problem.held_out]
    return [RunOut(name, each) for name, each in seconds if each]
