"""Options of the command line, which pytest only takes from here when no folder is named; no test is timed."""

from __future__ import annotations

import hypothesis
import pytest

hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--brick",
        metavar="URL",
        default=None,
        help="check this brick: motors turn for a moment; the ultrasonic sensor has to be on port 4",
    )
