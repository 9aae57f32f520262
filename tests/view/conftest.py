"""Pages without their pictures, which take most of the time, for tests that read only the words."""

import pytest

from nxt_twin.view import svg


@pytest.fixture
def undrawn(monkeypatch):
    """Leaves each picture of a page blank."""
    monkeypatch.setattr(svg, "drawn_svg", lambda _: '<svg viewBox="0 0 1 1"></svg>')
