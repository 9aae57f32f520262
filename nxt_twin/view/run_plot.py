"""The picture of a run that was not fitted: both models, the command, the errors, and a close look."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.arrays import FloatArray
from nxt_twin.diagnose.diagnosis import HeldOutRun
from nxt_twin.view import palette
from nxt_twin.view.close_look import draw_close_look, mark_part, telling_part
from nxt_twin.view.numbers import plain
from nxt_twin.view.thinning import envelope, steps, without_infinities
from nxt_twin.view.traces import (
    ModelTrace,
    RunPicture,
    draw_measured,
    ordinate_bounds,
    stale_samples,
    traces_of,
    trusted,
    widened,
)

_PAGE_SIZE_IN = (10.4, 5.3)
_COLUMNS = 520


def run_figure(picture: RunPicture) -> Figure:
    """The picture of one held-out run at the page's size."""
    figure = Figure(figsize=_PAGE_SIZE_IN)
    draw_run(figure, picture, top=0.94)
    return figure


def draw_run(figure: Figure, picture: RunPicture, *, top: float) -> None:
    """Draw a held-out run into `figure`, below the fraction `top` of its height."""
    tall = {"top": top, "bottom": 0.085}
    grid = figure.add_gridspec(
        3, 1, left=0.055, right=0.6, height_ratios=(3.1, 0.9, 1.9), hspace=0.42, **tall
    )
    side = figure.add_gridspec(2, 1, left=0.655, right=0.905, height_ratios=(3.5, 1.5), hspace=0.42, **tall)
    traces = traces_of(picture)
    part = telling_part(picture.run, traces[0])
    signal = figure.add_subplot(grid[0])
    _draw_signal(signal, picture, traces)
    mark_part(signal, picture.run, part)
    command = figure.add_subplot(grid[1], sharex=signal)
    _draw_command(command, picture.run)
    error = figure.add_subplot(grid[2], sharex=signal)
    _draw_errors(error, picture, traces)
    for axes in (signal, command):
        axes.tick_params(labelbottom=False)
    palette.name_abscissa(error, "time (s)")
    draw_close_look(figure.add_subplot(side[0]), picture, traces, part)
    _draw_rmse(figure.add_subplot(side[1]), picture, traces)


def _draw_signal(axes: Axes, picture: RunPicture, traces: list[ModelTrace]) -> None:
    run = picture.run
    measured = trusted(run)
    factor, unit = palette.in_reach(measured, picture.unit)
    palette.dress(axes, f"{picture.quantity} ({unit})")
    _shade(axes, picture)
    _name_strongest(axes, picture)
    draw_measured(axes, run, slice(None), factor, _COLUMNS, dots=False)
    for trace in traces:
        axes.plot(*envelope(run.time_s, factor * trace.values, _COLUMNS), color=trace.colour, linewidth=1.1)
    low, high = ordinate_bounds(measured, traces)
    axes.set_ylim(factor * low, factor * high)
    axes.set_xlim(run.time_s[0], run.time_s[-1])
    outside = [trace for trace in traces if _leaves(trace.values, low, high)]
    for row, trace in enumerate(outside):
        farthest = plain(float(trace.values[np.nanargmax(np.abs(trace.values))]))
        axes.text(
            0.99, 0.04 + 0.08 * row, f"{trace.name} leaves the picture, to {farthest} {picture.unit}",
            transform=axes.transAxes, ha="right", parse_math=False, fontsize=palette.SMALL_PT,
            color=trace.colour,
        )  # fmt: skip
    if stale_samples(run).any():
        axes.text(
            1.0, 1.02, "× stale sample, left out", transform=axes.transAxes, ha="right", va="bottom",
            fontsize=palette.SMALL_PT, color=palette.STALE,
        )  # fmt: skip


def _shade(axes: Axes, picture: RunPicture) -> None:
    for spell in picture.shaded:
        axes.axvspan(spell.start_s, spell.end_s, color=palette.SPELL, linewidth=0, zorder=0)


def _name_strongest(axes: Axes, picture: RunPicture) -> None:
    """Write the strength of the strongest spell above it."""
    if not picture.shaded:
        return
    strongest, time_s = picture.shaded[0], picture.run.time_s
    middle_s = (max(strongest.start_s, time_s[0]) + min(strongest.end_s, time_s[-1])) / 2
    place = float((middle_s - time_s[0]) / (time_s[-1] - time_s[0]))
    leftmost = 0.05 + 0.013 * len(axes.get_title(loc="left"))
    rightmost = 0.68 if stale_samples(picture.run).any() else 0.96
    place = min(max(place, leftmost), rightmost)
    axes.text(
        place, 1.02, f"{plain(strongest.strength, 2)} σ", transform=axes.transAxes,
        ha="center", va="bottom", fontsize=palette.SMALL_PT, color=palette.SPELL_INK,
    )  # fmt: skip


def _draw_command(axes: Axes, run: HeldOutRun) -> None:
    factor, unit = palette.in_reach(run.command, "")
    palette.dress(axes, f"{run.command_label}{f', in {unit.strip()}' if unit else ''}", ticks=2)
    time_s, command = steps(run.time_s, without_infinities(factor * run.command))
    time_s, command = envelope(time_s, command, _COLUMNS)
    axes.fill_between(time_s, command, step="post", color=palette.GRID, linewidth=0)
    axes.step(time_s, command, where="post", color=palette.MUTED, linewidth=0.9)
    axes.margins(y=0.15)


def _draw_errors(axes: Axes, picture: RunPicture, traces: list[ModelTrace]) -> None:
    run = picture.run
    low, high = _error_bounds(run, traces)
    factor, unit = palette.in_reach(np.array([low, high]), picture.unit)
    palette.dress(axes, f"error: model − measured ({unit})")
    _shade(axes, picture)
    axes.axhline(0, color=palette.LINE, linewidth=0.8, zorder=1)
    for trace in traces:
        axes.plot(*envelope(run.time_s, factor * trace.error, _COLUMNS), color=trace.colour, linewidth=1.0)
    axes.set_ylim(factor * low, factor * high)


def _error_bounds(run: HeldOutRun, traces: list[ModelTrace]) -> tuple[float, float]:
    """Limits around zero that hold every error, up to the size of the motion itself."""
    errors = np.concatenate([trace.error for trace in traces])
    motion = 1.2 * float(np.nanmax(trusted(run)) - np.nanmin(trusted(run))) or np.inf
    low = max(float(np.nanmin(errors, initial=0.0)), -motion)
    high = min(float(np.nanmax(errors, initial=0.0)), motion)
    return widened(low, high)


def _draw_rmse(axes: Axes, picture: RunPicture, traces: list[ModelTrace]) -> None:
    bars = [(trace.name, trace.colour, trace.rmse) for trace in traces]
    bars.append((picture.names[2], palette.NOISE, picture.floor))
    longest = max((value for _, _, value in bars if np.isfinite(value)), default=0.0) or 1.0
    factor, unit = palette.in_reach(np.array([longest]), picture.unit)
    palette.dress(axes, f"RMSE of this run ({unit})")
    axes.grid(visible=False)
    axes.spines[["left", "bottom"]].set_visible(False)
    for row, (name, colour, value) in enumerate(bars):
        length = min(value, longest) / longest if np.isfinite(value) else 1.0
        axes.barh(row, length, height=0.34, color=colour)
        axes.text(
            length + 0.025,
            row,
            plain(factor * value),
            va="center",
            fontsize=palette.TEXT_PT,
            color=palette.INK,
        )
        axes.text(0, row - 0.24, name, va="bottom", fontsize=palette.SMALL_PT, color=palette.MUTED)
    axes.set_ylim(len(bars) - 0.5, -0.75)
    axes.set_xlim(0, 1.2)
    axes.set_xticks([])
    axes.set_yticks([])


def _leaves(values: FloatArray, low: float, high: float) -> bool:
    return bool(np.nanmin(values, initial=low) < low or np.nanmax(values, initial=high) > high)
