"""``pytest tests/conformance --brick URL`` runs the checks on a brick of yours instead of on fakes."""

from __future__ import annotations

import pytest
from conformance_bricks import BRICKS

from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick as open_by_url


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--brick",
        metavar="URL",
        default=None,
        help="check this brick: motors turn for a moment; the ultrasonic sensor has to be on port 4",
    )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "open_brick" in metafunc.fixturenames:
        url = metafunc.config.getoption("--brick", default=None)
        metafunc.parametrize("open_brick", [url] if url else list(BRICKS), indirect=True)


@pytest.fixture
def open_brick(request: pytest.FixtureRequest):
    name = request.param
    if name not in BRICKS:
        yield lambda: open_by_url(name, SystemClock())
        return
    with BRICKS[name]() as opener:
        yield opener
