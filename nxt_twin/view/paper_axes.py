"""The axes of the paper's pictures: two beside each other, in the house's look."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nxt_twin.view import palette

_SIZE_IN = (10.4, 3.1)


def pair() -> tuple[Figure, tuple[Axes, Axes]]:
    """A picture of two halves."""
    figure = Figure(figsize=_SIZE_IN)
    grid = figure.add_gridspec(1, 2, left=0.05, right=0.985, top=0.9, bottom=0.16, wspace=0.16)
    return figure, (figure.add_subplot(grid[0]), figure.add_subplot(grid[1]))


def draw(axes: Axes, ordinate: str, abscissa: str) -> None:
    """The house's look, with what each axis is and its unit."""
    palette.dress(axes, ordinate)
    palette.name_abscissa(axes, abscissa)
