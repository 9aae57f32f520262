"""A figure's panels one below the other, for a page that is as narrow as a phone."""

from __future__ import annotations

from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.view import palette
from nxt_twin.view.legends import name_curves, names_in

_WIDTH_IN: Final = 5.0
_LEFT_IN: Final = 0.52
_RIGHT_IN: Final = 0.14
_NAMES_IN: Final = 0.85
"""Room for the names of curves beside their ends."""
_TITLE_IN: Final = 0.32
_TICKS_IN: Final = 0.26
_LABEL_IN: Final = 0.2


def stack(figure: Figure) -> None:
    """Put the panels of `figure` one below the other, each as high as it was, in the order in which they were made."""
    axes = figure.axes
    for each in axes:
        _stand_alone(each)
    heights_in = [each.get_position().height * figure.get_figheight() for each in axes]
    below_in = [_below_in(each) for each in axes]
    widths_in = [_WIDTH_IN - _LEFT_IN - (_NAMES_IN if _names_beside(each) else _RIGHT_IN) for each in axes]
    titles_in = [_above_in(each, width_in) for each, width_in in zip(axes, widths_in, strict=True)]
    total_in = sum(heights_in) + sum(below_in) + sum(titles_in)
    figure.set_size_inches(_WIDTH_IN, total_in)
    top_in = total_in
    places = zip(axes, widths_in, heights_in, below_in, titles_in, strict=True)
    for each, width_in, height_in, under_in, title_in in places:
        top_in -= title_in + height_in
        box = (_LEFT_IN / _WIDTH_IN, top_in / total_in, width_in / _WIDTH_IN, height_in / total_in)
        each.set_position(box)
        if each.get_legend():
            name_curves(each)
        top_in -= under_in


def _stand_alone(axes: Axes) -> None:
    """Give a panel its title, by its label, and its numbers, where it left both to the panel beside it."""
    if axes.get_label() and not axes.get_title(loc="left"):
        palette.name_panel(axes, str(axes.get_label()))
        axes.tick_params(labelleft=True)


def _above_in(axes: Axes, width_in: float) -> float:
    lines = 1 + axes.get_title(loc="left").count("\n")
    return _TITLE_IN * lines + (names_in(axes, width_in) if axes.get_legend() else 0.0)


def _below_in(axes: Axes) -> float:
    ticks = any(label.get_visible() and label.get_text() for label in axes.get_xticklabels())
    return (_TICKS_IN if ticks else 0.04) + (_LABEL_IN if axes.get_xlabel() else 0.0)


def _names_beside(axes: Axes) -> bool:
    return any(text.get_transform() == axes.transAxes and text.get_position()[0] > 1.0 for text in axes.texts)
