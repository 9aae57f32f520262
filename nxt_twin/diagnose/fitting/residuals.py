"""The innovation that a plant leaves at each reading, and the plant's state at that moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.fitting.noise import with_noise
from nxt_twin.diagnose.fitting.target import Target
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.plant import Plant
from nxt_twin.physics.simulate import Job, Simulator


@final
@dataclass(frozen=True)
class Residuals:
    """Arrays of shape (readings,), recordings one after another.

    Attributes:
        run: which recording.
        time_s: since its beginning.
        normalised: innovation over its standard deviation; about 1 in size where nothing is missing.
        position, speed: of the plant, SI.
        acceleration: of the plant, in its own standard deviations.
        command: in force before the reading, SI.
        since_command_s: since that command began.
        command_change: by how much it had changed, over the largest change.
        gap_s: since the reading before.
        drive: torque or force of the drive, N·m or N.
        unknown: torque or force that the observer had to add, N·m or N.
    """

    run: IntArray
    time_s: FloatArray
    normalised: FloatArray
    position: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    command: FloatArray
    since_command_s: FloatArray
    command_change: FloatArray
    gap_s: FloatArray
    drive: FloatArray
    unknown: FloatArray


def residuals(simulator: Simulator, plant: Plant, target: Target, noise: Noise) -> Residuals:
    """The innovations of `plant` over the first thinning of each of the target's recordings, under `noise`."""
    tuned = with_noise(target, noise)
    seen: set[str] = set()
    parts: list[dict[str, FloatArray]] = []
    for job in tuned.jobs:
        if job.signals.name not in seen:
            parts.append(_of_one(simulator, plant, job, len(parts)))
            seen.add(job.signals.name)
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    joined["command_change"] /= max(float(np.abs(joined["command_change"]).max()), 1e-12)
    joined["acceleration"] /= max(float(np.std(joined["acceleration"])), 1e-12)
    return Residuals(run=joined.pop("run").astype(np.int64), **joined)


def _of_one(simulator: Simulator, plant: Plant, job: Job, number: int) -> dict[str, FloatArray]:
    signals = job.signals
    trace = simulator.trace(plant, job)
    read = np.isfinite(signals.measured) & ~job.start.at
    before = np.maximum(np.searchsorted(signals.command_time_s, signals.time_s, side="left") - 1, 0)
    changes = np.diff(signals.command, prepend=0.0)
    time_s = signals.time_s - signals.time_s[0]
    arrays = {
        "run": np.full(time_s.size, float(number)),
        "time_s": time_s,
        "normalised": (signals.measured - trace["predicted"])
        / job.observer.innovation_std
        * np.sqrt(trace["weight"]),
        "position": trace["angle"],
        "speed": trace["speed"],
        "acceleration": np.gradient(
            trace["speed"], np.maximum.accumulate(time_s + 1e-9 * np.arange(time_s.size))
        ),
        "command": signals.command_at_samples(),
        "since_command_s": np.maximum(signals.time_s - signals.command_time_s[before], 0.0),
        "command_change": changes[before],
        "gap_s": np.diff(time_s, prepend=time_s[0]),
        "drive": trace["drive_torque"],
        "unknown": trace["disturbance"] * plant.values[Slot(BASE_OWNER, "inertia")],
    }
    return {key: values[read] for key, values in arrays.items()}
