"""The course of a plant's state in a recording, predicted before each reading corrected it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Simulator

_STANDING_SHARE = 1e-3  # of the largest speed between two stamps, below which the plant stands


@final
@dataclass(frozen=True)
class Course:
    """Arrays of shape (samples,), SI.

    Nothing here knows the reading of its own stamp: what goes with a reading's noise would explain it.

    Attributes:
        job: the recording and its gains.
        time_s: since the recording's beginning, never falling.
        laid_s: the same with all recordings laid end to end.
        position, speed: at the stamp.
        passed, pace: position and speed on average since the stamp before.
        standing: dry friction holds the plant.
        acceleration: since the stamp before.
        drive: torque or force of the drive.
        command: in force just before the stamp.
    """

    job: Job
    time_s: FloatArray
    laid_s: FloatArray
    position: FloatArray
    speed: FloatArray
    passed: FloatArray
    pace: FloatArray
    standing: BoolArray
    acceleration: FloatArray
    drive: FloatArray
    command: FloatArray


def course_of(simulator: Simulator, plant: Plant, job: Job, begins_s: float) -> Course:
    """Run `plant` through `job`, which begins at `begins_s` where all recordings are laid end to end."""
    trace = simulator.trace(plant, job)
    signals = job.signals
    read = np.isfinite(signals.measured) & ~job.start.at
    surprise = np.where(read, signals.measured - trace["predicted"], 0.0)
    position = trace["angle"] - job.observer.gains[:, 0] * surprise
    speed = trace["speed"] - job.observer.gains[:, 1] * surprise
    since_s = signals.time_s - signals.time_s[0]
    time_s = np.maximum.accumulate(since_s + 1e-9 * np.arange(since_s.size))
    before = np.concatenate([speed[:1], trace["speed"][:-1]])
    pace = 0.5 * (speed + before)
    return Course(
        job=job,
        time_s=time_s,
        laid_s=begins_s + time_s,
        position=position,
        speed=speed,
        passed=0.5 * (position + np.concatenate([position[:1], trace["angle"][:-1]])),
        pace=pace,
        standing=np.abs(pace) < _STANDING_SHARE * max(float(np.abs(pace).max()), 1e-12),
        acceleration=(speed - before) / np.diff(time_s, prepend=time_s[0] - 1.0),
        drive=trace["drive_torque"],
        command=signals.command_at_samples(),
    )
