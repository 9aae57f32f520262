"""Fewer points, same picture: long traces and clouds cut down to what a screen can show."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import final

import numpy as np

from nxt_twin.arrays import FloatArray, IntArray

_LEAST_IN_BIN = 12
_LEAST_GAP = 20.0  # times the usual step
_LEAST_GAP_SHARE = 0.04


def without_infinities(values: FloatArray) -> FloatArray:
    """`values` with infinities turned into NaN, so that a run-away prediction leaves a gap."""
    return np.where(np.isfinite(values), values, np.nan)


def gaps(time_s: FloatArray) -> IntArray:
    """The samples after which the stamps leave out a stretch, shape (gaps,)."""
    steps_s = np.diff(time_s)
    usual_s = float(np.median(steps_s)) if steps_s.size else 0.0
    return np.flatnonzero(steps_s > max(_LEAST_GAP * usual_s, _LEAST_GAP_SHARE * float(np.ptp(time_s))))


def envelope(time_s: FloatArray, values: FloatArray, columns: int) -> tuple[FloatArray, FloatArray]:
    """The smallest and the largest sample of each pixel column, in time order, so that peaks survive.

    Args:
        time_s: non-decreasing stamps, shape (samples,).
        values: shape (samples,); NaN is a gap.
        columns: how many pixel columns the trace is drawn on.

    Returns:
        Time and values, both of shape (at most 2·columns,); a column without a finite value becomes one NaN.
    """
    if values.size <= 2 * columns:
        return time_s, values
    edges = np.linspace(time_s[0], time_s[-1], columns + 1)[1:-1]
    bounds = np.concatenate(([0], np.searchsorted(time_s, edges), [values.size]))
    unknown = np.isnan(values)
    low, high = np.where(unknown, np.inf, values), np.where(unknown, -np.inf, values)
    kept: list[int] = []
    for first, last in pairwise(bounds.tolist()):
        if first < last:
            kept.extend(
                sorted({first + int(low[first:last].argmin()), first + int(high[first:last].argmax())})
            )
    index = np.array(kept, dtype=np.intp)
    return time_s[index], values[index]


def steps(time_s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Only the samples at which a held value changes, and the last one."""
    held = np.concatenate(([True], (np.diff(values) != 0) & ~np.isnan(values[1:])))
    held[-1] = True
    return time_s[held], values[held]


def some(candidates: IntArray, count: int) -> IntArray:
    """At most `count` of the indices, evenly spread over their order."""
    if candidates.size <= count:
        return candidates
    return candidates[np.linspace(0, candidates.size - 1, count).astype(np.intp)]


def random_indices(samples: int, count: int) -> IntArray:
    """At most `count` of the indices below `samples`, drawn at random with a fixed seed, against aliasing."""
    if samples <= count:
        return np.arange(samples, dtype=np.intp)
    return np.sort(np.random.default_rng(0).choice(samples, count, replace=False))


@final
@dataclass(frozen=True)
class Trend:
    """The shape of a cloud along its abscissa: median and middle 80 %, shape (bins,), and its counts.

    `share` is the part of the cloud's variance that the binned mean accounts for, 0…1.
    """

    at: FloatArray
    low: FloatArray
    median: FloatArray
    high: FloatArray
    share: float


def trend(along: FloatArray, values: FloatArray, bins: int = 36) -> Trend:
    """Bin `values` over equal stretches of `along` (both of shape (samples,)); thin bins are left out."""
    inside = np.isfinite(along) & np.isfinite(values)
    along, values = along[inside], values[inside]
    if along.size < _LEAST_IN_BIN or np.ptp(along) == 0:
        empty = np.empty(0)
        return Trend(empty, empty, empty, empty, 0.0)
    low, high = np.quantile(along, (0.002, 0.998))
    place = np.digitize(along, np.linspace(float(low), float(high), bins + 1)[1:-1])
    rows, explained = [], 0.0
    for number in range(bins):
        chosen = place == number
        if np.count_nonzero(chosen) < _LEAST_IN_BIN:
            continue
        held = values[chosen]
        rows.append((np.mean(along[chosen]), *np.quantile(held, (0.1, 0.5, 0.9))))
        explained += held.size * float(np.mean(held) - np.mean(values)) ** 2
    at, lower, median, upper = np.array(rows, dtype=np.float64).reshape(-1, 4).T
    spread = float(np.var(values)) * values.size
    return Trend(at, lower, median, upper, explained / spread if spread > 0 else 0.0)
