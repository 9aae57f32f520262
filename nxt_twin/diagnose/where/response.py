"""How innovations answer to what is missing: a torque, a rate of the count, or an error of the readings."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numba import njit

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.where.course import Course
from nxt_twin.physics.observer import Noise
from nxt_twin.physics.simulate import Job

Entry = Literal["torque", "count", "reading"]
_ENTRIES: dict[Entry, int] = {"torque": 0, "count": 1, "reading": 2}


def response(job: Job, course: Course, noise: Noise, rows: FloatArray, entry: Entry) -> FloatArray:
    """What `rows` add to each innovation, to first order, SI, shape (rows, samples).

    While the plant stands, dry friction bears what torque is missing.

    Args:
        job: the recording, with the gains under which it is run.
        course: when the plant stands.
        noise: its damping and its memory.
        rows: what is missing, shape (rows, samples): torque over inertia or rate of the count since the stamp
            before, or the reading's error at the stamp.
        entry: which of the three.
    """
    found = np.zeros(rows.shape)
    signals = job.signals
    _respond(
        signals.time_s,
        np.isfinite(signals.measured) & ~job.start.at,
        course.standing,
        job.observer.gains,
        noise.damping_per_s,
        1.0 / noise.disturbance_time_s,
        1 if signals.is_speed else 0,
        rows,
        _ENTRIES[entry],
        found,
    )
    return found


@njit(cache=True, nogil=True)
def _respond(  # type: ignore[no-untyped-def]  # noqa: ANN202  # compiled: numba infers the types
    time_s,  # noqa: ANN001
    known,  # noqa: ANN001
    standing,  # noqa: ANN001
    gains,  # noqa: ANN001
    damping_per_s,  # noqa: ANN001
    leak_per_s,  # noqa: ANN001
    read,  # noqa: ANN001
    rows,  # noqa: ANN001
    entry,  # noqa: ANN001
    found,  # noqa: ANN001
):
    dt = np.diff(time_s)
    hold = np.exp(-damping_per_s * dt)
    gain = (1.0 - hold) / damping_per_s if damping_per_s > 1e-9 else dt
    half = 0.5 * dt * dt
    forget = np.exp(-leak_per_s * dt)
    for i in range(rows.shape[0]):
        missing = np.zeros(2)  # position and speed that the run does not know of
        angle = speed = push = 0.0  # what the observer made of it
        for k in range(1, time_s.shape[0]):
            j = k - 1
            angle += gain[j] * speed + half[j] * push
            speed = hold[j] * speed + gain[j] * push
            push *= forget[j]
            if standing[k]:
                speed = missing[1] = 0.0
            elif entry == 0:
                missing[0] += gain[j] * missing[1] + half[j] * rows[i, k]
                missing[1] = hold[j] * missing[1] + gain[j] * rows[i, k]
            if entry == 1:
                missing[0] += dt[j] * rows[i, k]
                missing[1] = rows[i, k]
            elif entry == 2:
                missing[read] = rows[i, k]
            if not known[k]:
                continue
            e = missing[read] - (speed if read == 1 else angle)
            found[i, k] = e
            angle += gains[k, 0] * e
            speed += gains[k, 1] * e
            push += gains[k, 2] * e
