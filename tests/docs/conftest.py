"""The tools of the documentation, which stand in tools/."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session", autouse=True)
def _tools():
    """Let the tests import what stands in tools/."""
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(ROOT / "tools")
    yield
    patch.undo()


@pytest.fixture(scope="session")
def root():
    """The project's folder."""
    return ROOT
