"""One side of a comparison: its recordings as windows of simulation, some fitted and some that only check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.splits import length_s
from nxt_twin.diagnose.fitting.structure import SETTLED_STEP_S
from nxt_twin.physics.observer import Noise, observer
from nxt_twin.physics.signals import Signals
from nxt_twin.physics.simulate import Job, Simulator, free_job
from nxt_twin.physics.start import moving_start, restarts
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

Which = Literal["fitted", "check", "everything"]

LONGEST_WINDOW_S = 1.0  # of simulation; short recordings have shorter windows
READINGS_A_WINDOW = 4.0
"""Independent readings in a window of simulation, whose errors go together from its beginning to its end."""

_NEEDS_NO_SUPPLY = ("voltage_v", "current_a", "torque_nm", "force_n")
_FEWEST_WINDOWS = 6  # into which the shortest recording is cut
_CYCLE = 3  # windows: fit, fit, check


@final
@dataclass(frozen=True)
class Side:
    """Recordings of one state of the plant.

    Attributes:
        name: the case's.
        jobs: one a recording, started anew from smoothed readings at the beginning of each window.
        window: the window of each sample, counted through all recordings, shape (samples,) by job.
        fitted: which samples are fitted, shape (samples,) by job.
        check: which samples only check a choice, likewise.
        corrected: the recordings run as one, corrected at each reading: they tell the states at the windows' starts.
    """

    name: str
    jobs: tuple[Job, ...]
    window: tuple[IntArray, ...]
    fitted: tuple[BoolArray, ...]
    check: tuple[BoolArray, ...]
    corrected: tuple[Job, ...]

    def with_states(
        self, simulator: Simulator, values: FloatArray, active: BoolArray
    ) -> list[tuple[Job, ...]]:
        """The jobs, each window of which starts with the hidden states that a plant has reached, corrected until then.

        A load behind play lies on the flank that the motor has pushed last, not in the middle of its play.

        Args:
            simulator: of the plant's layout.
            values: SI values of the plants in the layout's order, shape (plants, parameters).
            active: which effects act, shape (plants, effects).

        Returns:
            By recording, one job a plant.
        """
        starts = simulator.reached_by(values, active, self.corrected, [job.start.at for job in self.jobs])
        return [
            tuple(replace(job, start=start) for start in own)
            for job, own in zip(self.jobs, starts, strict=True)
        ]

    def masks(self, which: Which) -> tuple[BoolArray, ...]:
        """The samples of that use by job."""
        if which == "fitted":
            return self.fitted
        both = zip(self.fitted, self.check, strict=True)
        return self.check if which == "check" else tuple(a | b for a, b in both)

    def weight(self, which: Which) -> float:
        """How many independent readings one sample of that use is worth."""
        masks = self.masks(which)
        windows = sum(np.unique(w[m]).size for w, m in zip(self.window, masks, strict=True))
        return READINGS_A_WINDOW * windows / max(sum(int(mask.sum()) for mask in masks), 1)

    def worth(self, which: Which) -> float:
        """How many independent readings the samples of that use are worth."""
        return self.weight(which) * sum(int(mask.sum()) for mask in self.masks(which))

    def measured(self, which: Which) -> FloatArray:
        """Readings of that use, end to end."""
        masks = self.masks(which)
        return np.concatenate([j.signals.measured[m] for j, m in zip(self.jobs, masks, strict=True)])

    def windows(self, which: Which) -> IntArray:
        """The window of each reading of that use, end to end."""
        return np.concatenate([w[m] for w, m in zip(self.window, self.masks(which), strict=True)])

    def recordings(self, which: Which) -> IntArray:
        """The number of the recording of each reading of that use, end to end."""
        masks = self.masks(which)
        return np.concatenate([np.full(int(mask.sum()), n) for n, mask in enumerate(masks)])


def every_signal(problem: Problem) -> tuple[Signals, ...]:
    """All recordings of a problem, those that it holds out included, each once."""
    known = {signals.name: signals for signals in problem.signals}
    known |= {part.signals.name: part.signals for part in problem.held_out}
    return tuple(known.values())


def supply_unread(case: Case) -> bool:
    """Whether duty drives a recording of the case during which nobody read the supply."""
    return any(_is_unread(recording) for recording in (*case.recordings, *case.holdout))


def _is_unread(recording: Recording) -> bool:
    kinds = recording.kinds
    if kinds is not None and kinds.input in _NEEDS_NO_SUPPLY:
        return False
    read = [recording.columns[name] for name in ("battery_v", "supply_v") if name in recording.columns]
    return not any(np.isfinite(volts).any() for volts in read)


def window_for(signals: Sequence[Signals]) -> float:
    """The length of the windows of simulation in which recordings are compared, s."""
    return min(LONGEST_WINDOW_S, min(length_s(one) for one in signals) / _FEWEST_WINDOWS)


def side_of(
    name: str, signals: Sequence[Signals], checking: frozenset[str], window_s: float, noise: Noise
) -> Side:
    """Make a side ready.

    Args:
        name: the case's.
        signals: its recordings.
        checking: names of recordings that must not be fitted; without any, each third window checks.
        window_s: length of the windows.
        noise: of the readings.
    """
    jobs, windows, fitted, check, corrected, first = [], [], [], [], [], 0
    for one in signals:
        start = restarts(one, window_s)
        window = np.asarray(np.cumsum(start.at) - 1 + first, dtype=np.int64)
        first = int(window[-1]) + 1
        read = np.isfinite(one.measured) & ~start.at
        checks = np.full(read.size, one.name in checking) if checking else window % _CYCLE == _CYCLE - 1
        jobs.append(Job(one, free_job(one, start).observer, start, step_s=SETTLED_STEP_S))
        windows.append(window)
        fitted.append(np.asarray(read & ~checks))
        check.append(np.asarray(read & checks))
        corrected.append(Job(one, observer(one, noise), moving_start(one), noise.disturbance_time_s))
    return Side(name, tuple(jobs), tuple(windows), tuple(fitted), tuple(check), tuple(corrected))
