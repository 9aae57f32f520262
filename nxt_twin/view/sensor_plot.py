"""The picture of a sensor's held-out readings: what it said and what the two models expect, against the truth."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.arrays import FloatArray, IntArray
from nxt_twin.diagnose.diagnosis import HeldOutRun
from nxt_twin.view import palette
from nxt_twin.view.legends import name_all_curves
from nxt_twin.view.thinning import some
from nxt_twin.view.traces import ModelTrace, RunPicture, traces_of, trusted
from nxt_twin.view.wording import spelled_out

_RIG = "rig_"
_SIZE_IN = (10.4, 5.6)
_MOST_DOTS = 900
_DOT: dict[str, Any] = {"linestyle": "none", "marker": "o", "markeredgewidth": 0}
_SHOWN_QUANTILES = (0.005, 0.995)


def is_of_sensor(run: HeldOutRun) -> bool:
    """Whether a run is of a sensor on a rig: its command is then the true value."""
    return run.command_label.startswith(_RIG)


def sensor_figure(picture: RunPicture) -> Figure:
    """Reading against truth, error against truth, and error over time."""
    figure = Figure(figsize=_SIZE_IN)
    grid = figure.add_gridspec(
        2, 2, left=0.055, right=0.985, top=0.94, bottom=0.085, width_ratios=(1.7, 1.0), hspace=0.38, wspace=0.12
    )  # fmt: skip
    traces, truth = traces_of(picture), picture.run.command
    kept = some(np.arange(truth.size), _MOST_DOTS)
    reading = figure.add_subplot(grid[0, :])
    _draw_readings(reading, picture, traces, kept)
    for place, abscissa, title in (
        (grid[1, 0], truth, _truth_title(picture.run)),
        (grid[1, 1], picture.run.time_s, "time (s)"),
    ):
        axes = figure.add_subplot(place)
        _draw_errors(axes, picture, traces, abscissa[kept], kept)
        palette.name_abscissa(axes, title)
    name_all_curves(figure)
    return figure


def _draw_readings(axes: Axes, picture: RunPicture, traces: list[ModelTrace], kept: IntArray) -> None:
    palette.dress(axes, f"{picture.quantity} ({picture.unit})")
    truth = picture.run.command[kept]
    axes.plot(
        truth, trusted(picture.run)[kept], color=palette.MEASURED, markersize=4.6, label="measured", **_DOT
    )
    for trace in traces:
        label = f"{trace.name}, error {trace.rmse:.3g} {picture.unit}"
        axes.plot(truth, trace.values[kept], color=trace.colour, markersize=2.4, label=label, **_DOT)
    palette.name_abscissa(axes, _truth_title(picture.run))
    axes.margins(y=0.12)


def _draw_errors(
    axes: Axes, picture: RunPicture, traces: list[ModelTrace], abscissa: FloatArray, kept: IntArray
) -> None:
    palette.dress(axes, f"error: model − measured ({picture.unit})")
    axes.axhline(0, color=palette.LINE, linewidth=0.8, zorder=1)
    for trace in traces:
        axes.plot(abscissa, trace.error[kept], color=trace.colour, markersize=2.8, alpha=0.75, **_DOT)
    errors = np.concatenate([trace.error for trace in traces])
    low, high = np.nanquantile(errors, _SHOWN_QUANTILES)
    margin = 0.1 * float(high - low) or 1.0
    axes.set_ylim(min(float(low), 0.0) - margin, max(float(high), 0.0) + margin)


def _truth_title(run: HeldOutRun) -> str:
    """`true distance (mm)` of `rig_distance_mm`."""
    unit = run.command_label.rsplit("_", 1)[-1]
    return f"true {spelled_out(run.command_label).removeprefix('rig ')} ({unit})"
