"""Options of the command line, which pytest only takes from here when no folder is named; no test is timed."""

from __future__ import annotations

import os

import hypothesis
import pytest

# Matrices are small here: a second thread of BLAS only waits in a loop, a third of a diagnosis' processor time.
os.environ.setdefault("OMP_NUM_THREADS", "1")

hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--brick",
        metavar="URL",
        default=None,
        help="check this brick: motors turn for a moment; the ultrasonic sensor has to be on port 4",
    )
