"""The picture of a robot's held-out run: its path on the floor, before and after, and the error over time."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import DrivenPath
from nxt_twin.view import palette
from nxt_twin.view.legends import name_all_curves
from nxt_twin.view.numbers import plain
from nxt_twin.view.thinning import envelope
from nxt_twin.view.traces import ModelTrace, RunPicture, traces_of

_SIZE_IN = (10.4, 5.0)
_COLUMNS = 480
_MOST_POINTS = 1200


def robot_figure(picture: RunPicture, path: DrivenPath) -> Figure:
    """The floor from above on the left, on the right the distance from the measured place over time."""
    figure = Figure(figsize=_SIZE_IN)
    grid = figure.add_gridspec(
        2, 2, left=0.055, right=0.985, top=0.93, bottom=0.095, width_ratios=(1.35, 1.0), hspace=0.4, wspace=0.13
    )  # fmt: skip
    traces = traces_of(picture)
    _draw_floor(figure.add_subplot(grid[:, 0]), path, traces)
    _draw_distance(figure.add_subplot(grid[0, 1]), picture, traces)
    _draw_speed(figure.add_subplot(grid[1, 1]), picture)
    name_all_curves(figure)
    return figure


def _draw_floor(axes: Axes, path: DrivenPath, traces: list[ModelTrace]) -> None:
    palette.dress(axes, "path on the floor: y to the left of the start (m)")
    axes.grid(visible=True, color=palette.GRID, linewidth=0.8)
    every = max(1, len(path.measured) // _MOST_POINTS)
    axes.plot(*path.measured[::every].T, color=palette.MEASURED, linewidth=3.2, label="measured")
    axes.plot(
        *path.given[::every].T,
        color=palette.MUTED,
        linewidth=0.9,
        linestyle=(0, (4, 2)),
        label="model as given",
    )
    predicted: list[FloatArray] = [path.baseline, path.improved]
    for trace, places in zip(traces, predicted, strict=False):
        label = f"{trace.name}, error {plain(trace.rmse)} mm"
        axes.plot(*places[::every].T, color=trace.colour, linewidth=1.1, label=label)
        axes.plot(*places[-1], marker="o", markersize=4.5, color=trace.colour, linestyle="none")
    axes.plot(*path.measured[-1], marker="o", markersize=6, color=palette.MEASURED_INK, linestyle="none")
    axes.plot(*path.measured[0], marker="s", markersize=5, color=palette.INK, linestyle="none", label="start")
    axes.set_aspect("equal", adjustable="datalim")
    palette.name_abscissa(axes, "x ahead of the start (m); round dots: where each ends")
    axes.margins(0.08)


def _draw_distance(axes: Axes, picture: RunPicture, traces: list[ModelTrace]) -> None:
    palette.dress(axes, "distance between predicted and measured place (mm)")
    for spell in picture.spells:
        axes.axvspan(spell.start_s, spell.end_s, color=palette.SPELL, linewidth=0, zorder=0)
    for trace in traces:
        axes.plot(*envelope(picture.run.time_s, trace.values, _COLUMNS), color=trace.colour, linewidth=1.1)
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(picture.run.time_s[0], picture.run.time_s[-1])


def _draw_speed(axes: Axes, picture: RunPicture) -> None:
    palette.dress(axes, picture.run.command_label)
    axes.plot(
        *envelope(picture.run.time_s, picture.run.command, _COLUMNS), color=palette.MUTED, linewidth=0.9
    )
    axes.set_xlim(picture.run.time_s[0], picture.run.time_s[-1])
    palette.name_abscissa(axes, "time (s)")
