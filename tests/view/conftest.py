"""Pages without their pictures, which take most of the time, for tests that read only the words."""

import pytest
from matplotlib.figure import Figure

from nxt_twin.view import live_report, report, svg

FIGURES = {
    report: ("held_out_figure", "leftover_figure"),
    live_report: ("motor_figure", "sensors_figure", "link_figure"),
}


@pytest.fixture
def undrawn(monkeypatch):
    """Leaves each picture of a page blank."""
    monkeypatch.setattr(svg, "drawn_svg", lambda _: '<svg viewBox="0 0 1 1"></svg>')
    for page, names in FIGURES.items():
        for name in names:
            monkeypatch.setattr(page, name, lambda *_args, **_options: Figure())
