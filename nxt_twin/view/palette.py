"""The colours and the axes of every picture; one colour means one thing throughout (Okabe and Ito's set)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from nxt_twin.arrays import FloatArray
from nxt_twin.view.numbers import power_of_ten

MEASURED = "#a3adb8"
MEASURED_INK = "#56616c"
BASELINE = "#d55e00"
IMPROVED = "#0072b2"
NOISE = "#c3cad2"
STALE = "#a4478d"
SPELL = "#f7ecc9"
SPELL_INK = "#8a6a00"
INK = "#1b1f24"
MUTED = "#5b6570"
LINE = "#c9d0d7"
GRID = "#eceff2"

THEMED = (
    "MEASURED", "MEASURED_INK", "BASELINE", "IMPROVED", "NOISE", "STALE", "SPELL", "SPELL_INK", "INK", "MUTED", "LINE",
    "GRID",
)  # fmt: skip
"""Colours that a page's style may replace, each by the variable `--c-` and its name."""

TEXT_PT = 8.4
SMALL_PT = 7.6


def dress(axes: Axes, title: str, *, ticks: int = 4) -> None:
    """Give axes the house's look: two thin spines, faint grid, what and unit written above."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(LINE)
    axes.spines[["left", "bottom"]].set_linewidth(0.8)
    axes.tick_params(colors=MUTED, labelsize=SMALL_PT, length=2.5, width=0.8, color=LINE)
    axes.grid(visible=True, axis="y", color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.yaxis.set_major_locator(MaxNLocator(ticks, min_n_ticks=2))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(ScalarFormatter(useOffset=False, useMathText=False))
        axis.get_major_formatter().set_scientific(False)  # type: ignore[attr-defined]
    if title:
        name_panel(axes, title)


def name_panel(axes: Axes, title: str) -> None:
    """Write above the panel what it shows, and the unit."""
    axes.set_title(title, loc="left", fontsize=TEXT_PT, color=MUTED, pad=5, parse_math=False)


def name_abscissa(axes: Axes, title: str) -> None:
    """Write what the abscissa is, and its unit."""
    axes.set_xlabel(title, fontsize=TEXT_PT, color=MUTED, labelpad=3, parse_math=False)


def in_reach(values: FloatArray, unit: str) -> tuple[float, str]:
    """A power of ten that brings `values` near one, as the factor to draw with and the unit to write."""
    peak = float(np.nanmax(np.abs(values), initial=0.0))
    if peak == 0 or 0.02 <= peak < 1e5:
        return 1.0, unit
    exponent = 3 * int(np.floor(np.log10(peak) / 3))
    return 10.0**-exponent, f"{power_of_ten(exponent)} {unit}"
