"""The shape of what is left: the unknown torque against speed, position and time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import Leftover
from nxt_twin.view import palette
from nxt_twin.view.thinning import random_indices, trend, without_infinities

_WIDTH_IN = 10.4
_MOST_DOTS = 1500
_LEAST_SHARE = 0.05
_TURN = {"deg": 360.0, "rad": 2 * np.pi}


@final
@dataclass(frozen=True)
class _Row:
    title: str
    colour: str
    torque: FloatArray


@final
@dataclass(frozen=True)
class _Abscissa:
    title: str
    values: FloatArray


def leftover_figure(leftover: Leftover, *, improves: bool) -> Figure:
    """One row for the re-fitted baseline and one for the improved plant, where there is one, on one scale."""
    rows = _rows(leftover, improves=improves)
    height_in = 2.5 * len(rows) + 0.45
    figure = Figure(figsize=(_WIDTH_IN, height_in))
    place = {"left": 0.055, "right": 0.985, "top": 1 - 0.32 / height_in, "bottom": 0.5 / height_in}
    abscissas = _abscissas(leftover)
    grid = figure.add_gridspec(len(rows), len(abscissas), hspace=0.28, wspace=0.12, **place)
    factor, unit = palette.in_reach(rows[0].torque, leftover.unit)
    limit = factor * _limit([row.torque for row in rows])
    kept = random_indices(leftover.time_s.size, _MOST_DOTS)
    for column, abscissa in enumerate(abscissas):
        for number, row in enumerate(rows):
            axes = figure.add_subplot(grid[number, column])
            _draw_cloud(axes, abscissa, factor * row.torque, row.colour, kept)
            palette.dress(axes, f"{row.title} ({unit})" if column == 0 else "")
            axes.set_label(f"{row.title} ({unit})")
            axes.set_ylim(-limit, limit)
            axes.xaxis.set_major_locator(MaxNLocator(6))
            lowest = number == len(rows) - 1
            axes.tick_params(labelleft=column == 0, labelbottom=lowest)
            if lowest:
                palette.name_abscissa(axes, abscissa.title)
    return figure


def _rows(leftover: Leftover, *, improves: bool) -> list[_Row]:
    what = "unknown force" if leftover.unit == "N" else "unknown torque"
    before, after = without_infinities(leftover.before), without_infinities(leftover.after)
    if not improves:
        return [_Row(what, palette.BASELINE, before)]
    return [
        _Row(f"{what}, before", palette.BASELINE, before),
        _Row(f"{what}, after", palette.IMPROVED, after),
    ]


def _limit(torques: list[FloatArray]) -> float:
    sizes = np.abs(np.concatenate(torques))
    sizes = sizes[np.isfinite(sizes)]
    return 1.25 * float(np.quantile(sizes, 0.995)) if sizes.size and np.any(sizes) else 1.0


def _abscissas(leftover: Leftover) -> list[_Abscissa]:
    drive = (
        []
        if leftover.drive is None
        else [_Abscissa(leftover.drive_label, without_infinities(leftover.drive))]
    )
    return [
        _Abscissa(f"speed ({leftover.speed_unit})", without_infinities(leftover.speed)),
        _telling_position(leftover),
        *drive,
        _Abscissa("time in the recording (s)", leftover.time_s),
    ]


def _telling_position(leftover: Leftover) -> _Abscissa:
    """Position as it is, or within one turn, whichever the unknown torque goes with more closely."""
    position = without_infinities(leftover.position)
    straight = _Abscissa(f"position ({leftover.position_unit})", position)
    turn = _TURN.get(leftover.position_unit)
    if (
        turn is None
        or not np.isfinite(position).any()
        or np.nanmax(position) - np.nanmin(position) < 1.5 * turn
    ):
        return straight
    within = _Abscissa(f"position within a turn ({leftover.position_unit})", position % turn)
    torque = without_infinities(leftover.before)
    return max(within, straight, key=lambda abscissa: trend(abscissa.values, torque).share)


def _draw_cloud(axes: Axes, abscissa: _Abscissa, torque: FloatArray, colour: str, kept: IntArray) -> None:
    """Dots for single samples, a band for the middle 80 % and a line for the median."""
    axes.axhline(0, color=palette.LINE, linewidth=0.8, zorder=1)
    along = abscissa.values
    shown = kept[np.isfinite(along[kept]) & np.isfinite(torque[kept])]
    points = np.column_stack((along[shown], torque[shown]))
    if not points.size:
        return
    # one path of dots of no length and round ends: a tenth of the text of one element a dot
    dots = Path(np.repeat(points, 2, axis=0), np.tile([Path.MOVETO, Path.LINETO], len(points)))
    dots.should_simplify = False
    patch = PathPatch(
        dots, edgecolor=palette.MEASURED, facecolor="none", linewidth=1.7, capstyle="round", alpha=0.55
    )
    axes.add_artist(patch)
    axes.update_datalim(points)  # a patch is searched for bends, dot by dot
    middle = trend(along, torque)
    axes.fill_between(middle.at, middle.low, middle.high, color=colour, alpha=0.16, linewidth=0, zorder=3)
    axes.plot(middle.at, middle.median, color=colour, linewidth=1.8, zorder=4)
    low, high = float(along[shown].min()), float(along[shown].max())
    margin = 0.02 * (high - low) or 1.0
    axes.set_xlim(low - margin, high + margin)
    if middle.at.size:
        share = f"{100 * middle.share:.0f}" if middle.share >= _LEAST_SHARE else f"< {100 * _LEAST_SHARE:.0f}"
        axes.text(
            0.99, 0.98, f"{share} % of its variance", transform=axes.transAxes,
            ha="right", va="top", fontsize=palette.SMALL_PT, color=palette.MUTED,
        )  # fmt: skip
