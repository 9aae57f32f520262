"""A structure in its recordings, and what something missing there would add to its innovations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.fitting.kalman import deviation
from nxt_twin.diagnose.fitting.linear import Linear
from nxt_twin.diagnose.fitting.problem import Problem
from nxt_twin.diagnose.where.course import Course, course_of
from nxt_twin.diagnose.where.response import Entry, response
from nxt_twin.diagnose.where.shapes import Yardstick, yardstick
from nxt_twin.physics.simulate import Simulator


@final
@dataclass(frozen=True)
class Staged:
    """A structure in these recordings: what it did, and how far readings are from it uncorrected.

    Each reading counts for `evidence` readings.
    """

    simulator: Simulator
    evidence: float
    courses: tuple[Course, ...]
    deviations: tuple[FloatArray, ...]
    unit: Yardstick


def staged(simulator: Simulator, problem: Problem, linear: Linear) -> Staged:
    """Run the structure of `linear` through its recordings."""
    plant, noise = linear.structure.plant, linear.structure.noise
    begins_s: dict[str, float] = {}
    courses: list[Course] = []
    for job in linear.jobs:
        ends_s = float(courses[-1].laid_s[-1]) if courses else 0.0
        courses.append(course_of(simulator, plant, job, begins_s.setdefault(job.signals.name, ends_s)))
    deviations = tuple(
        deviation(job, predicted, noise) for job, predicted in zip(linear.jobs, linear.predicted, strict=True)
    )
    return Staged(simulator, problem.target.evidence[0], tuple(courses), deviations, yardstick(courses))


def answers(scene: Staged, linear: Linear, rows: Iterator[FloatArray], entry: Entry) -> Iterator[FloatArray]:
    """What `rows`, a part a job, add to the counted innovations, in standard deviations, by job."""
    noise = linear.structure.noise
    for number, (job, course) in enumerate(zip(linear.jobs, scene.courses, strict=True)):
        yield whitened_part(linear, number, response(job, course, noise, next(rows), entry))


def whitened(linear: Linear, parts: Sequence[FloatArray]) -> FloatArray:
    """Innovations of all jobs, SI, in standard deviations at the counted readings, shape (..., readings)."""
    return np.concatenate([whitened_part(linear, *part) for part in enumerate(parts)], axis=-1)


def whitened_part(linear: Linear, number: int, part: FloatArray) -> FloatArray:
    """Innovations of one job, in the order of `linear`, in standard deviations at its counted readings."""
    counted = np.flatnonzero(linear.counted[number])
    found = np.take(part, counted, axis=-1)
    found *= linear.gain[number][counted]
    return found
