"""Which column is the slope of another: an angle beside its speed, whatever they are called."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.recording.guess.profile import TableColumn

_MOST_COLUMNS = 24
_LEAST_SHARE = 0.999  # of a reading's variance, which the integral of its slope explains
_LARGEST_LEAP = 0.5  # of its span, between two rows: commands leap, and motion cannot


def slopes_of(
    columns: Sequence[TableColumn], time: TableColumn | None, groups: Iterable[slice]
) -> dict[str, str]:
    """By a column's name, that of the column which is its slope, up to a gain; empty where no time is known.

    Args:
        columns: candidates, all but the time.
        time: the stamps.
        groups: the rows of each recording.
    """
    runs = list(groups)
    moving = [each for each in columns[:_MOST_COLUMNS] if _moves(each)]
    if time is None or not np.isfinite(time.values).all():
        return {}
    return {
        angle.name: speed.name
        for angle in moving
        for speed in moving
        if angle is not speed and _is_slope(speed.values, angle.values, time.values, runs)
    }


def _moves(column: TableColumn) -> bool:
    """Whether it changes smoothly and has no empty cell."""
    known = column.known.size == column.values.size and column.span > 0.0
    return known and float(np.abs(np.diff(column.values)).max()) < _LARGEST_LEAP * column.span


def _is_slope(slope: FloatArray, reading: FloatArray, time: FloatArray, runs: Sequence[slice]) -> bool:
    """Whether the integral of one column, times a gain, is the other in every run."""
    sums, travelled = [], []
    for run in runs:
        middle = 0.5 * (slope[run][1:] + slope[run][:-1])
        sums.append(np.concatenate([[0.0], np.cumsum(middle * np.diff(time[run]))]))
        travelled.append(reading[run] - reading[run][0])
    integral, moved = np.concatenate(sums), np.concatenate(travelled)
    size = float(integral @ integral)
    left = moved - (float(integral @ moved) / size if size > 0.0 else 0.0) * integral
    return bool(left @ left <= (1.0 - _LEAST_SHARE) * (moved @ moved)) and bool(np.ptp(slope) > 0.0)
