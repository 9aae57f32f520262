"""The recordings of a sensor case as readings beside the truth that a rig has set."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import DiagnosisError
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

COLUMNS: Final[Mapping[str, str]] = {
    "ultrasonic_sensor": r"s[1-4]_ultrasonic_cm",
    "light_sensor": r"s[1-4]_light_raw",
    "touch_sensor": r"s[1-4]_touch",
}
"""By kind of sensor, the columns that may hold its reading."""

KINDS: Final = tuple(COLUMNS)

TRUTHS: Final[Mapping[str, tuple[str, ...]]] = {
    "ultrasonic_sensor": ("rig_distance_mm",),
    "light_sensor": ("rig_position_mm",),
    "touch_sensor": ("rig_force_g", "rig_compression_mm"),
}
"""By kind of sensor, the rig's columns that it is held against, the better one first."""

_BESIDE: Final = ("rig_angle_deg",)
_FEWEST_READINGS: Final = 12  # not held out, below which a case is refused


@final
@dataclass(frozen=True)
class SensorRun:
    """One recording's readings of the sensor, with the truth at each; arrays of shape (readings,).

    Attributes:
        truth: by the rig's column.
        held_out: whether the case forbids fitting it.
    """

    name: str
    time_s: FloatArray
    readings: FloatArray
    truth: Mapping[str, FloatArray]
    held_out: bool


def channel_of(case: Case, kind: str) -> str:
    """The sensor's column: the first of its kind that every recording has.

    Raises:
        DiagnosisError: there is none.
    """
    runs = (*case.recordings, *case.holdout)
    shared = set.intersection(*(set(run.columns) for run in runs))
    found = sorted(name for name in shared if re.fullmatch(COLUMNS[kind], name))
    full = [name for name in found if all(np.isfinite(run.columns[name]).any() for run in runs)]
    if not full:
        mend = f"record a column like {COLUMNS[kind].replace('[1-4]', '4')}"
        raise DiagnosisError(f"no recording of a {kind}", where=case.name, mend=mend)
    return full[0]


def truth_column(case: Case, kind: str) -> str:
    """The rig's column that this kind of sensor is held against.

    Raises:
        DiagnosisError: a recording has none, so that nothing says what the sensor should have read.
    """
    runs = (*case.recordings, *case.holdout)
    for name in TRUTHS[kind]:
        if all(name in run.columns and np.isfinite(run.columns[name]).any() for run in runs):
            return name
    wanted = " or ".join(TRUTHS[kind])
    what = f"nothing says what the sensor should have read: {wanted} is missing"
    mend = "record the true value beside the reading; `nxt-twin fit` tells step, pace and noise without it"
    raise DiagnosisError(what, where=case.name, mend=mend)


def has_truth(case: Case, kind: str) -> bool:
    """Whether a rig says what the sensor should have read."""
    runs = (*case.recordings, *case.holdout)
    return any(
        all(name in run.columns and np.isfinite(run.columns[name]).any() for run in runs)
        for name in TRUTHS[kind]
    )


def unit_of(name: str) -> str:
    """The unit of a parameter by its name's ending."""
    endings = {"_raw_per_mm": "raw/mm", "_mm": "mm", "_g": "g", "_raw": "raw"}
    return next((unit for ending, unit in endings.items() if name.endswith(ending)), "")


def runs_of(case: Case, kind: str) -> tuple[SensorRun, ...]:
    """The case's recordings as runs; rows without a reading go, truths between rows are interpolated.

    Raises:
        DiagnosisError: no reading, no truth, or too little of them.
    """
    channel, truth = channel_of(case, kind), truth_column(case, kind)
    runs = [_run(recording, channel, truth, held_out=False) for recording in case.recordings]
    runs += [_run(recording, channel, truth, held_out=True) for recording in case.holdout]
    if sum(run.readings.size for run in runs if not run.held_out) < _FEWEST_READINGS:
        mend = f"at least {_FEWEST_READINGS} are needed"
        raise DiagnosisError("too few readings", where=case.name, mend=mend)
    return tuple(runs)


def _run(recording: Recording, channel: str, truth: str, *, held_out: bool) -> SensorRun:
    columns, time_s = recording.columns, recording.time_s
    rows = np.flatnonzero(np.isfinite(columns[channel]))
    truths = {truth: filled(time_s, columns[truth])[rows]}
    for name in _BESIDE:
        if name in columns and np.isfinite(columns[name]).any():
            truths[name] = filled(time_s, columns[name])[rows]
    return SensorRun(recording.name, time_s[rows], columns[channel][rows], truths, held_out)


def filled(time_s: FloatArray, values: FloatArray) -> FloatArray:
    """A rig's column, its empty rows filled in along straight lines."""
    known = np.isfinite(values)
    return np.asarray(np.interp(time_s, time_s[known], values[known]), dtype=np.float64)
