"""The pictures of a fleet: its parameters with those that stand out, and what drifts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from nxt_twin.arrays import FloatArray
from nxt_twin.fleet.findings.values import Findings, FleetParameter, UnitDrift
from nxt_twin.view import palette
from nxt_twin.view.wording import spelled_out

_WIDTH_IN: Final = 10.4
_COLUMNS: Final = 3
_PANEL_IN: Final = 1.75
_BINS: Final = 30


def parameters_figure(findings: Findings) -> Figure:
    """How many units have which value of each parameter; units that stand out are marked."""
    figure, panels = _panels(len(findings.parameters))
    for axes, parameter in zip(panels, findings.parameters, strict=True):
        far = [each.value for each in findings.outliers if each.parameter == parameter.name]
        _draw_parameter(axes, parameter, np.array(far))
    return figure


def drifts_figure(drifts: Sequence[UnitDrift], units: dict[str, str]) -> Figure:
    """Each drifting parameter over time, with the standard deviations of its fits and its line.

    Args:
        drifts: what to draw.
        units: of the parameters, by name.
    """
    figure, panels = _panels(len(drifts))
    for axes, drift in zip(panels, drifts, strict=True):
        _draw_drift(axes, drift, units.get(drift.parameter, ""))
    return figure


def _panels(count: int) -> tuple[Figure, list[Axes]]:
    rows = max(1, -(-count // _COLUMNS))
    height = 0.25 + rows * (_PANEL_IN + 0.75)
    figure = Figure(figsize=(_WIDTH_IN, height))
    grid = figure.add_gridspec(
        rows, _COLUMNS, left=0.055, right=0.985, top=1.0 - 0.3 / height, bottom=0.45 / height, hspace=0.5, wspace=0.24
    )  # fmt: skip
    return figure, [figure.add_subplot(grid[n // _COLUMNS, n % _COLUMNS]) for n in range(count)]


def _draw_parameter(axes: Axes, parameter: FleetParameter, far: FloatArray) -> None:
    values = np.array(parameter.values)
    factor, unit = palette.in_reach(values, parameter.unit)
    palette.dress(axes, f"units by {spelled_out(parameter.name)}", ticks=3)
    edges = np.histogram_bin_edges(values * factor, _BINS).tolist()
    axes.hist(values * factor, edges, color=palette.MEASURED)
    if far.size:
        axes.hist(far * factor, edges, color=palette.BASELINE)
    axes.axvline(parameter.median * factor, color=palette.INK, linewidth=1.0)
    axes.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    palette.name_abscissa(axes, unit or " ")


def _draw_drift(axes: Axes, drift: UnitDrift, unit: str) -> None:
    at, values, stds = (np.array(each) for each in (drift.at, drift.values, drift.stds))
    factor, unit = palette.in_reach(values, unit)
    name = f"{drift.unit}: {spelled_out(drift.parameter)}"
    palette.dress(axes, f"{name} ({unit})" if unit else name, ticks=3)
    weight = 1.0 / stds**2
    middle, mean = (float(np.sum(weight * each) / np.sum(weight)) for each in (at, values))
    ends = np.array([at.min(), at.max()])
    axes.plot(ends, (mean + drift.slope * (ends - middle)) * factor, color=palette.IMPROVED, linewidth=1.4)
    axes.errorbar(
        at, values * factor, 2.0 * stds * factor, color=palette.MEASURED_INK, fmt="o", markersize=4, linewidth=1.0
    )  # fmt: skip
    palette.name_abscissa(axes, "days" if drift.per == "day" else "sessions")
