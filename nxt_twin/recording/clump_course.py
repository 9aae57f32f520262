"""When the last rows of clumps were read: an even course through the moments at which the clumps came."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from nxt_twin.arrays import BoolArray, FloatArray, IntArray

_EVEN: Final = 0.01  # of the time from row to row: no rows are taken for more even than that
_STALLED: Final = 4.0  # standard deviations beyond which a host or a link kept a clump waiting
_FAR: Final = 16  # clumps over which the walk is told from the waits
_NORMAL: Final = 1.4826  # of a normal variable: its standard deviation over the median of its absolute values


@final
@dataclass(frozen=True)
class ClumpCourse:
    """How clumps come.

    Attributes:
        read_s: when the last row of each clump was read, shape (clumps,).
        open_s2: the variance of that, s², shape (clumps,).
        stalled: which clumps waited, shape (clumps,).
        row_s: the time from row to row.
        walk_s2: the variance of that, s².
    """

    read_s: FloatArray
    open_s2: FloatArray
    stalled: BoolArray
    row_s: float
    walk_s2: float


def even_course(came_s: FloatArray, sizes: IntArray, usual_s: float) -> ClumpCourse:
    """Tell the unevenness of the rows from that of the link, and smooth the one by the other (Rauch, Tung, Striebel).

    The time from one last row to the next is a random walk about `sizes` usual times. Each clump waits a while after
    its last row. Where a timer sends what there is, that wait is even between zero and one row's time. Otherwise the
    intervals tell its variance, as a wait lengthens one of them and shortens the next.

    Args:
        came_s: when each clump came, shape (clumps,).
        sizes: the rows in each, shape (clumps,).
        usual_s: about the usual time from row to row.
    """
    apart_s, rows = np.diff(came_s), sizes[1:]
    stalled = _waited(apart_s - rows * usual_s, usual_s)
    row_s = float(np.sum(apart_s[~stalled]) / np.sum(rows[~stalled]))
    off_s = apart_s - rows * row_s
    stalled = _waited(off_s, row_s)
    wait_s2, walk_s2 = _variances_s2(np.where(stalled, 0.0, off_s), float(np.mean(sizes)))
    if _is_by_timer(apart_s[~stalled], rows[~stalled], row_s):
        wait_s2 = row_s**2 / 12.0
        stalled = off_s > row_s + _STALLED * math.sqrt(float(np.mean(sizes)) * walk_s2)
        _, walk_s2 = _variances_s2(np.where(stalled, 0.0, off_s), float(np.mean(sizes)))
    steps_s = np.asarray(rows * row_s + np.where(stalled, off_s, 0.0), dtype=np.float64)
    walk_s2 = max(walk_s2, (_EVEN * row_s) ** 2)
    walks_s2 = np.asarray(rows * walk_s2 + np.where(stalled, row_s**2, 0.0), dtype=np.float64)
    smooth_s, open_s2 = walk_smoothed(came_s - np.sqrt(3.0 * wait_s2), steps_s, walks_s2, wait_s2)
    return ClumpCourse(np.minimum(smooth_s, came_s), open_s2, np.append(False, stalled), row_s, walk_s2)


def _waited(off_s: FloatArray, row_s: float) -> BoolArray:
    """Which intervals are longer than chance makes them."""
    return np.asarray(off_s > max(row_s, _STALLED * _NORMAL * float(np.median(np.abs(off_s)))))


def _is_by_timer(apart_s: FloatArray, rows: IntArray, row_s: float) -> bool:
    """Whether clumps with more rows are no longer in coming."""
    more = rows - np.mean(rows)
    return bool(np.sum(more * apart_s) < 0.5 * row_s * np.sum(more**2))


def _variances_s2(off_s: FloatArray, rows: float) -> tuple[float, float]:
    """Variances of the wait after a clump's last row and of the time from one row to the next, s².

    That of the wait is at least its own standard error: no last row is known exactly.
    """
    far = min(_FAR, off_s.size // 4)
    if far < 2:
        return 0.0, 0.0
    course_s = np.append(0.0, np.cumsum(off_s))
    near_s2, far_s2 = (float(np.mean((course_s[k:] - course_s[:-k]) ** 2)) for k in (1, far))
    walk_s2 = max(0.0, far_s2 - near_s2) / ((far - 1) * rows)
    return max(near_s2 - rows * walk_s2, near_s2 * math.sqrt(2.0 / off_s.size)) / 2.0, walk_s2


def walk_smoothed(
    observed_s: FloatArray, steps_s: FloatArray, walk_s2: FloatArray, noise_s2: float
) -> tuple[FloatArray, FloatArray]:
    """A random walk seen under noise, from the step and variance of each move: its course, and the variance of that."""
    if noise_s2 == 0.0:
        return observed_s, np.zeros(observed_s.size)
    mean_s, variance = float(observed_s[0]), noise_s2
    means, variances, ahead_s2 = [mean_s], [variance], []
    for seen_s, step_s, walk in zip(observed_s[1:].tolist(), steps_s.tolist(), walk_s2.tolist(), strict=True):
        ahead_s, ahead = mean_s + step_s, variance + walk
        gain = ahead / (ahead + noise_s2)
        mean_s, variance = ahead_s + gain * (seen_s - ahead_s), (1.0 - gain) * ahead
        means.append(mean_s)
        variances.append(variance)
        ahead_s2.append(ahead)
    for k in range(len(ahead_s2) - 1, -1, -1):
        back = variances[k] / ahead_s2[k]
        means[k] += back * (means[k + 1] - means[k] - float(steps_s[k]))
        variances[k] += back * back * (variances[k + 1] - ahead_s2[k])
    return np.asarray(means), np.asarray(variances)
