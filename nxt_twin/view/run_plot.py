"""A run that was not fitted: measured against both models, the command, the errors, and a close look."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from nxt_twin.diagnose.diagnosis import Diagnosis, HeldOutRun, Spell
from nxt_twin.recording.recording import FloatArray
from nxt_twin.view import palette
from nxt_twin.view.numbers import plain
from nxt_twin.view.thinning import envelope, finite, some, steps
from nxt_twin.view.wording import improves, quantity

PAGE_SIZE_IN = (10.4, 5.3)

_COLUMNS = 640
_CLOSE_COLUMNS = 260
_MOST_MARKS = 120
_DOTS_UP_TO = 140
_FEWEST_ASIDE = 12
_LABEL_GAP = 0.07
_LONG_STAMP_S = 1e4

BoolArray = NDArray[np.bool_]


@final
@dataclass(frozen=True)
class RunPicture:
    """One held-out run and what is said of it.

    Attributes:
        spells: the stretches of this run in which the baseline fails, strongest first.
        improves: whether there is an improved model to draw beside the baseline.
        floor: the error that noise alone would give, in `unit`.
    """

    run: HeldOutRun
    quantity: str
    unit: str
    spells: tuple[Spell, ...]
    improves: bool
    floor: float


@final
@dataclass(frozen=True)
class _Trace:
    name: str
    colour: str
    values: FloatArray
    error: FloatArray
    rmse: float


def picture_of(diagnosis: Diagnosis, run: HeldOutRun) -> RunPicture:
    """Gather what the picture of one held-out run shows."""
    start_s, end_s = run.time_s[0], run.time_s[-1]
    spells = [
        spell
        for spell in diagnosis.mismatch.when
        if spell.recording == run.recording and spell.end_s > start_s and spell.start_s < end_s
    ]
    spells.sort(key=lambda spell: -spell.strength)
    return RunPicture(
        run=run,
        quantity=quantity(diagnosis.mismatch.channel),
        unit=diagnosis.fit.unit,
        spells=tuple(spells),
        improves=improves(diagnosis),
        floor=diagnosis.fit.floor,
    )


def run_figure(picture: RunPicture) -> Figure:
    """The picture of one held-out run at the page's size."""
    figure = Figure(figsize=PAGE_SIZE_IN)
    draw_run(figure, picture, top=0.94)
    return figure


def draw_run(figure: Figure, picture: RunPicture, *, top: float) -> None:
    """Draw a held-out run into `figure`, below the fraction `top` of its height."""
    tall = {"top": top, "bottom": 0.085}
    grid = figure.add_gridspec(
        3, 1, left=0.055, right=0.6, height_ratios=(3.1, 0.9, 1.9), hspace=0.42, **tall
    )
    side = figure.add_gridspec(2, 1, left=0.655, right=0.905, height_ratios=(3.5, 1.5), hspace=0.42, **tall)
    traces = _traces(picture)
    part = _telling_part(picture.run, traces[0])
    signal = figure.add_subplot(grid[0])
    _draw_signal(signal, picture, traces)
    _mark_part(signal, picture.run, part)
    command = figure.add_subplot(grid[1], sharex=signal)
    _draw_command(command, picture.run)
    error = figure.add_subplot(grid[2], sharex=signal)
    _draw_errors(error, picture, traces)
    for axes in (signal, command):
        axes.tick_params(labelbottom=False)
    palette.name_abscissa(error, "time (s)")
    _draw_close_look(figure.add_subplot(side[0]), picture, traces, part)
    _draw_rmse(figure.add_subplot(side[1]), picture, traces)


def _traces(picture: RunPicture) -> list[_Trace]:
    run = picture.run
    trusted = _trusted(run)
    baseline = finite(run.baseline)
    traces = [_Trace("baseline", palette.BASELINE, baseline, baseline - trusted, run.baseline_rmse)]
    if picture.improves:
        improved = finite(run.improved)
        traces.append(_Trace("improved", palette.IMPROVED, improved, improved - trusted, run.improved_rmse))
    return traces


def _bounds(measured: FloatArray, traces: list[_Trace]) -> tuple[float, float]:
    """Ordinate limits that show the measurement whole, and of a run-away prediction as much as fits."""
    low, high = float(np.nanmin(measured)), float(np.nanmax(measured))
    reach = 0.6 * (high - low) or np.inf
    lowest = min(float(np.nanmin(trace.values, initial=low)) for trace in traces)
    highest = max(float(np.nanmax(trace.values, initial=high)) for trace in traces)
    return _widened(max(lowest, low - reach), min(highest, high + reach))


def _widened(low: float, high: float) -> tuple[float, float]:
    margin = 0.07 * (high - low) or max(abs(low), 1.0) * 1e-3
    return low - margin, high + margin


def _draw_signal(axes: Axes, picture: RunPicture, traces: list[_Trace]) -> None:
    run = picture.run
    measured = _trusted(run)
    factor, unit = palette.in_reach(measured, picture.unit)
    palette.dress(axes, f"{picture.quantity} ({unit})")
    _shade(axes, picture)
    _name_strongest(axes, picture)
    _draw_measured(axes, run, slice(None), factor, _COLUMNS, dots=False)
    for trace in traces:
        axes.plot(*envelope(run.time_s, factor * trace.values, _COLUMNS), color=trace.colour, linewidth=1.1)
    low, high = _bounds(measured, traces)
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
    if _stale(run).any():
        axes.text(
            1.0, 1.02, "× stale sample, left out", transform=axes.transAxes, ha="right", va="bottom",
            fontsize=palette.SMALL_PT, color=palette.STALE,
        )  # fmt: skip


def _leaves(values: FloatArray, low: float, high: float) -> bool:
    return bool(np.nanmin(values, initial=low) < low or np.nanmax(values, initial=high) > high)


def _trusted(run: HeldOutRun) -> FloatArray:
    return np.where(run.stale > 0.5, np.nan, finite(run.measured))


def _stale(run: HeldOutRun) -> BoolArray:
    return (run.stale > 0.5) & np.isfinite(run.measured)


def _draw_measured(
    axes: Axes, run: HeldOutRun, part: slice, factor: float, columns: int, *, dots: bool
) -> None:
    """Draw what was measured, as a line or as dots, and the stale samples beside it as crosses."""
    time_s, measured, stale = run.time_s[part], factor * finite(run.measured[part]), _stale(run)[part]
    style = {"marker": "o", "markersize": 3.4, "linestyle": "none"} if dots else {"linewidth": 2.8}
    axes.plot(*envelope(time_s[~stale], measured[~stale], columns), color=palette.MEASURED, **style)
    marked = some(np.flatnonzero(stale), _MOST_MARKS)
    axes.plot(
        time_s[marked], measured[marked], linestyle="none", marker="x", markersize=4,
        markeredgewidth=1.1, color=palette.STALE, zorder=4,
    )  # fmt: skip


def _shade(axes: Axes, picture: RunPicture) -> None:
    for spell in picture.spells:
        axes.axvspan(spell.start_s, spell.end_s, color=palette.SPELL, linewidth=0, zorder=0)


def _name_strongest(axes: Axes, picture: RunPicture) -> None:
    """Write the strength of the strongest spell above it."""
    if not picture.spells:
        return
    strongest, time_s = picture.spells[0], picture.run.time_s
    middle_s = (max(strongest.start_s, time_s[0]) + min(strongest.end_s, time_s[-1])) / 2
    place = float((middle_s - time_s[0]) / (time_s[-1] - time_s[0]))
    leftmost = 0.05 + 0.013 * len(axes.get_title(loc="left"))
    rightmost = 0.68 if _stale(picture.run).any() else 0.96
    place = min(max(place, leftmost), rightmost)
    axes.text(
        place, 1.02, f"{plain(strongest.strength, 2)} σ", transform=axes.transAxes,
        ha="center", va="bottom", fontsize=palette.SMALL_PT, color=palette.SPELL_INK,
    )  # fmt: skip


def _draw_command(axes: Axes, run: HeldOutRun) -> None:
    factor, unit = palette.in_reach(run.command, "")
    palette.dress(axes, f"{run.command_label}{f', in {unit.strip()}' if unit else ''}", ticks=2)
    time_s, command = steps(run.time_s, finite(factor * run.command))
    time_s, command = envelope(time_s, command, _COLUMNS)
    axes.fill_between(time_s, command, step="post", color=palette.GRID, linewidth=0)
    axes.step(time_s, command, where="post", color=palette.MUTED, linewidth=0.9)
    axes.margins(y=0.15)


def _draw_errors(axes: Axes, picture: RunPicture, traces: list[_Trace]) -> None:
    run = picture.run
    low, high = _error_bounds(run, traces)
    factor, unit = palette.in_reach(np.array([low, high]), picture.unit)
    palette.dress(axes, f"error: model − measured ({unit})")
    _shade(axes, picture)
    axes.axhline(0, color=palette.LINE, linewidth=0.8, zorder=1)
    for trace in traces:
        axes.plot(*envelope(run.time_s, factor * trace.error, _COLUMNS), color=trace.colour, linewidth=1.0)
    axes.set_ylim(factor * low, factor * high)


def _error_bounds(run: HeldOutRun, traces: list[_Trace]) -> tuple[float, float]:
    """Limits around zero that hold every error, up to the size of the motion itself."""
    errors = np.concatenate([trace.error for trace in traces])
    motion = 1.2 * float(np.nanmax(_trusted(run)) - np.nanmin(_trusted(run))) or np.inf
    low = max(float(np.nanmin(errors, initial=0.0)), -motion)
    high = min(float(np.nanmax(errors, initial=0.0)), motion)
    return _widened(low, high)


def _telling_part(run: HeldOutRun, baseline: _Trace) -> slice:
    """The samples around the baseline's largest error, so few that error and motion are of one size."""
    measured, whole = _trusted(run), slice(0, run.time_s.size)
    motion = float(np.nanmax(measured) - np.nanmin(measured)) or np.inf
    error = np.abs(baseline.error)
    error[error > motion] = np.nan  # a prediction that has run away shows nothing up close
    if np.isnan(error).all():
        return whole
    centre, half = int(np.nanargmax(error)), run.time_s.size // 16
    part = _around(centre, half, run.time_s.size)
    while half > _FEWEST_ASIDE and np.nanmax(measured[part]) - np.nanmin(measured[part]) > 5 * error[centre]:
        half = int(half / 1.5)
        part = _around(centre, half, run.time_s.size)
    return part if run.time_s[part.stop - 1] > run.time_s[part.start] else whole


def _around(centre: int, half: int, size: int) -> slice:
    half = max(half, _FEWEST_ASIDE)
    first = max(0, min(centre - half, size - 2 * half - 1))
    return slice(first, min(first + 2 * half + 1, size))


def _mark_part(axes: Axes, run: HeldOutRun, part: slice) -> None:
    for edge in (run.time_s[part.start], run.time_s[part.stop - 1]):
        axes.axvline(edge, color=palette.MUTED, linewidth=0.7, linestyle=(0, (3, 2)), zorder=1)


def _draw_close_look(axes: Axes, picture: RunPicture, traces: list[_Trace], part: slice) -> None:
    run = picture.run
    time_s, measured = run.time_s[part], _trusted(run)[part]
    factor, unit = palette.in_reach(measured, picture.unit)
    palette.dress(axes, f"between the dashed lines ({unit})")
    dots = bool(np.count_nonzero(np.isfinite(measured)) <= _DOTS_UP_TO)
    _draw_measured(axes, run, part, factor, _CLOSE_COLUMNS, dots=dots)
    near = [replace(trace, values=trace.values[part]) for trace in traces]
    for trace in near:
        axes.plot(*envelope(time_s, factor * trace.values, _CLOSE_COLUMNS), color=trace.colour, linewidth=1.5)
    low, high = _bounds(measured, near)
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


def _draw_rmse(axes: Axes, picture: RunPicture, traces: list[_Trace]) -> None:
    bars = [(trace.name, trace.colour, trace.rmse) for trace in traces]
    bars.append(("noise alone", palette.NOISE, picture.floor))
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
