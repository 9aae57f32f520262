"""The names of curves above a panel, where they hide nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from nxt_twin.view import palette

ROW_IN: Final = 0.16
"""Height of a row of names, in."""
_POINTS_PER_INCH: Final = 72.0
_LETTER: Final = 0.56
"""Width of a letter over the size of its font, as the system fonts of browsers have it at most."""
_HANDLE_LETTERS: Final = 6.0
"""Room for a curve's sign and the gap behind its name, in letters."""
_TITLE_IN: Final = 0.2


@final
@dataclass(frozen=True)
class _Layout:
    """Where names stand: in how many columns, beside the title or over it, and how many rows higher than the title."""

    columns: int
    beside: bool
    extra_rows: int


def name_curves(axes: Axes) -> None:
    """Name the curves beside the panel's title, or in rows over it where both find no room in its width."""
    layout = _layout(axes, _width_in(axes))
    if layout is None:
        return
    above = ScaledTranslation(0.0, 0.0 if layout.beside else _TITLE_IN, axes.figure.dpi_scale_trans)
    axes.legend(
        loc="lower right" if layout.beside else "lower left",
        bbox_to_anchor=(1.0, 0.985) if layout.beside else (0.0, 1.0),
        bbox_transform=axes.transAxes + above,
        ncols=layout.columns,
        columnspacing=1.0,
        fontsize=palette.SMALL_PT,
        frameon=False,
        labelcolor=palette.MUTED,
        handlelength=1.4,
        borderaxespad=0.2,
    )


def name_all_curves(figure: Figure) -> None:
    """Name the curves of every panel, and make the figure higher where rows of names stand over the upper ones."""
    extra_in = 0.0
    for axes in figure.axes:
        name_curves(axes)
        extra_in = max(extra_in, names_in(axes, _width_in(axes)))
    before_in = figure.get_figheight()
    figure.set_figheight(before_in + extra_in)
    kept = before_in / (before_in + extra_in)
    for axes in figure.axes:
        box = axes.get_position()
        axes.set_position((box.x0, kept * box.y0, box.width, kept * box.height))


def names_in(axes: Axes, width_in: float) -> float:
    """Height that the names take above the title of a panel `width_in` wide, in; 0 without names."""
    layout = _layout(axes, width_in)
    return ROW_IN * layout.extra_rows if layout else 0.0


def _layout(axes: Axes, width_in: float) -> _Layout | None:
    """The lowest layout that fits; None if no curve has a name."""
    names = [len(name) + _HANDLE_LETTERS for name in axes.get_legend_handles_labels()[1]]
    if not names:
        return None
    letter_in = _LETTER * palette.SMALL_PT / _POINTS_PER_INCH
    room = width_in / letter_in
    room_beside = room - len(axes.get_title(loc="left")) * palette.TEXT_PT / palette.SMALL_PT
    layouts = [_Layout(1, beside=False, extra_rows=len(names))]
    for columns in range(len(names), 0, -1):
        rows = -(-len(names) // columns)
        taken = _taken(names, columns)
        if taken <= room_beside:
            layouts.append(_Layout(columns, beside=True, extra_rows=rows - 1))
        if taken <= room:
            layouts.append(_Layout(columns, beside=False, extra_rows=rows))
    return min(layouts, key=lambda layout: (layout.extra_rows, not layout.beside))


def _taken(names: list[float], columns: int) -> float:
    """Letters that the columns take beside each other; the first ones hold a name more where they do not divide."""
    rows, longer = divmod(len(names), columns)
    taken, at = 0.0, 0
    for column in range(columns):
        until = at + rows + (column < longer)
        taken, at = taken + max(names[at:until], default=0.0), until
    return taken


def _width_in(axes: Axes) -> float:
    return float(axes.get_position().width * axes.figure.get_figwidth())  # type: ignore[union-attr]
