"""The noise that a structure asks for beside what a complete one would leave, and how likely readings are under one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.diagnose.fitting.noise import estimate, reading_floor
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.fitting.structure import DRAFT_STEP_S, Structure, step_for
from nxt_twin.diagnose.where.staged import Staged
from nxt_twin.physics.layout import BASE_OWNER, Slot
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.simulate import Simulator

_COMPLETE_TORQUE = 3e-3  # of an ordinary torque: the unknown torque that a complete model leaves at most
_ABOVE_FLOOR = 1.5
"""The reading noise that a complete model leaves at most, over that of the readings' quantum."""


def noises(simulator: Simulator, problem: Problem, structure: Structure) -> tuple[Noise, Noise]:
    """The noise that a structure asks for, at least a complete model's, and the part of it that this would leave."""
    target = problem.everything()
    step_s = step_for(structure.plant, DRAFT_STEP_S)
    coarse = replace(target, jobs=tuple(replace(job, step_s=step_s) for job in target.jobs))
    likeliest, _ = estimate(simulator, structure.plant, coarse, structure.noise)
    least = _COMPLETE_TORQUE * problem.scale.torque / structure.plant.values[Slot(BASE_OWNER, "inertia")]
    asked = replace(likeliest, disturbance_std=max(likeliest.disturbance_std, least))
    floor = _ABOVE_FLOOR * reading_floor([job.signals for job in target.jobs])
    reading = min(asked.reading_std, floor) if floor > 0.0 else asked.reading_std
    return asked, replace(asked, reading_std=reading, disturbance_std=least)


def between(one: Noise, other: Noise) -> Noise:
    """The geometric mean of two noises."""
    return replace(
        one,
        reading_std=math.sqrt(one.reading_std * other.reading_std),
        disturbance_std=math.sqrt(one.disturbance_std * other.disturbance_std),
    )


def readings_nats(scene: Staged, linear: Linear) -> float:
    """Of the readings, with the parameters of the re-fit at their best, nats but for a constant."""
    left = linear.left_of(linear.innovations)[0]
    widths = [
        np.log(job.observer.innovation_std[mask])
        for job, mask in zip(linear.jobs, linear.counted, strict=True)
    ]
    return -scene.evidence * float(np.sum(np.concatenate(widths))) - 0.5 * float(left @ left)
