"""Rows whose stamps were rounded to a coarse step, at the moments at which an even course puts them."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.physics.signals import Signals
from nxt_twin.recording.clumps import told_apart_s
from nxt_twin.recording.rounded import course_through, rounding_s

_FEWEST_READINGS: Final = 40  # that tell a course from a device's own steps
_SMOOTHER: Final = (
    0.8  # of their roughness: readings that were taken on an even course have less by its moments
)


def evenly_read(signals: Signals) -> Signals:
    """The signals with their rows on an even course, each with its command; as they are where stamps are fine.

    A device may as well have read in such steps. So the readings have to be smoother by the course's moments.
    """
    step_s = rounding_s(signals.time_s)
    if step_s == 0.0 or signals.clump_rows or np.isfinite(signals.measured).sum() < _FEWEST_READINGS:
        return signals
    course = course_through(signals.time_s, step_s)
    if _roughness(course.time_s, signals.measured) > _SMOOTHER * _roughness(signals.time_s, signals.measured):
        return signals
    row = np.clip(np.searchsorted(signals.time_s, signals.command_time_s), 0, signals.time_s.size - 1)
    after_s = signals.command_time_s - signals.time_s[row]
    return replace(
        signals,
        time_s=told_apart_s(course.time_s),
        rounded_s=step_s,
        open_s=course.open_s,
        command_time_s=np.maximum.accumulate(course.time_s[row] + after_s),
        command_open_s=course.open_s[row],
    )


def _roughness(time_s: FloatArray, measured: FloatArray) -> float:
    """The mean square by which readings are off the line between their neighbours."""
    known = np.isfinite(measured)
    at_s, read = time_s[known], measured[known]
    span_s = np.maximum(at_s[2:] - at_s[:-2], 1e-9)
    share = (at_s[1:-1] - at_s[:-2]) / span_s
    return float(np.mean((read[1:-1] - read[:-2] - share * (read[2:] - read[:-2])) ** 2))
