"""The part of a held-out run that shows best how the models differ, drawn large."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from nxt_twin.arrays import BoolArray, FloatArray
from nxt_twin.diagnose.diagnosis import HeldOutRun
from nxt_twin.view import palette
from nxt_twin.view.thinning import envelope
from nxt_twin.view.traces import ModelTrace, RunPicture, draw_measured, ordinate_bounds, trusted

_COLUMNS = 260
_DOTS_UP_TO = 140
_FEWEST_ASIDE = 12
_LABEL_GAP = 0.07
_REACH = 3.0
"""Up close an error may be larger than the motion, and is what the panel is there to show."""
_LONG_STAMP_S = 1e4


def telling_part(run: HeldOutRun, baseline: ModelTrace) -> slice:
    """The samples around the baseline's largest error, so few that error and motion are of one size."""
    measured, whole = trusted(run), slice(0, run.time_s.size)
    motion = float(np.nanmax(measured) - np.nanmin(measured)) or np.inf
    error = np.abs(baseline.error)
    error[error > motion] = np.nan  # a prediction that has run away shows nothing up close
    error[~_in_company(run)] = np.nan
    if np.isnan(error).all():
        return whole
    centre, half = int(np.nanargmax(error)), run.time_s.size // 16
    part = _unbroken(run, _around(centre, half, run.time_s.size), centre)
    while half > _FEWEST_ASIDE and np.nanmax(measured[part]) - np.nanmin(measured[part]) > 5 * error[centre]:
        half = int(half / 1.5)
        part = _unbroken(run, _around(centre, half, run.time_s.size), centre)
    return part if run.time_s[part.stop - 1] > run.time_s[part.start] else whole


def _in_company(run: HeldOutRun) -> BoolArray:
    """The samples of stretches that are long enough to show a motion."""
    empty = np.isnan(run.stale)
    edges = np.flatnonzero(np.concatenate(([True], empty, [True])))
    long_enough = np.diff(edges) > 2 * _FEWEST_ASIDE
    return np.asarray(~empty & long_enough[np.cumsum(empty)], dtype=np.bool_)


def _unbroken(run: HeldOutRun, part: slice, centre: int) -> slice:
    """The stretch of `part` round `centre` in which nothing was left out."""
    empty = np.flatnonzero(np.isnan(run.stale))
    first = max([part.start, *(empty[empty < centre] + 1)])
    last = min([part.stop, *empty[empty > centre]])
    return slice(int(first), int(last))


def _around(centre: int, half: int, size: int) -> slice:
    half = max(half, _FEWEST_ASIDE)
    first = max(0, min(centre - half, size - 2 * half - 1))
    return slice(first, min(first + 2 * half + 1, size))


def mark_part(axes: Axes, run: HeldOutRun, part: slice) -> None:
    """Mark on the whole run which part is drawn large."""
    for edge in (run.time_s[part.start], run.time_s[part.stop - 1]):
        axes.axvline(edge, color=palette.MUTED, linewidth=0.7, linestyle=(0, (3, 2)), zorder=1)


def draw_close_look(axes: Axes, picture: RunPicture, traces: list[ModelTrace], part: slice) -> None:
    """Draw one part of the run, single samples as dots where they are few, each curve named at its end."""
    run = picture.run
    time_s, measured = run.time_s[part], trusted(run)[part]
    factor, unit = palette.in_reach(measured, picture.unit)
    palette.dress(axes, f"between the dashed lines ({unit})")
    dots = bool(np.count_nonzero(np.isfinite(measured)) <= _DOTS_UP_TO)
    draw_measured(axes, run, part, factor, _COLUMNS, dots=dots)
    near = [replace(trace, values=trace.values[part]) for trace in traces]
    for trace in near:
        axes.plot(*envelope(time_s, factor * trace.values, _COLUMNS), color=trace.colour, linewidth=1.5)
    low, high = ordinate_bounds(measured, near, reach=_REACH)
    axes.set_ylim(factor * low, factor * high)
    axes.set_xlim(time_s[0], time_s[-1])
    axes.xaxis.set_major_locator(MaxNLocator(5 if time_s[-1] < _LONG_STAMP_S else 3))
    palette.name_abscissa(axes, "time (s)")
    ends = [("measured", palette.MEASURED_INK, measured), *((t.name, t.colour, t.values) for t in near)]
    _label_ends(axes, [(name, colour, factor * values) for name, colour, values in ends])


def _label_ends(axes: Axes, ends: list[tuple[str, str, FloatArray]]) -> None:
    """Write each curve's name beside its right end, pushed apart where they would overlap."""
    low, high = axes.get_ylim()
    places: list[tuple[float, str, str]] = []
    for name, colour, values in ends:
        known = values[np.isfinite(values)]
        height = (float(known[-1]) - low) / (high - low) if known.size else 0.0
        places.append((min(max(height, 0.03), 0.97), name, colour))
    below = -np.inf
    for height, name, colour in sorted(places):
        below = max(height, below + _LABEL_GAP)
        axes.text(
            1.03, below, name, transform=axes.transAxes, va="center",
            fontsize=palette.TEXT_PT, color=colour, fontweight="bold",
        )  # fmt: skip
