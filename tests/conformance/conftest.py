"""``--brick URL`` (declared for all tests) runs the checks on a brick of yours instead of on fakes and mocks."""

from __future__ import annotations

import pytest
from conformance_bricks import BRICKS

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick as open_by_url


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "open_brick" in metafunc.fixturenames:
        url = metafunc.config.getoption("--brick", default=None)
        metafunc.parametrize("open_brick", [url] if url else list(BRICKS), indirect=True)


@pytest.fixture
def open_brick(request: pytest.FixtureRequest):
    name = request.param
    if name not in BRICKS:
        yield lambda: open_by_url(name, SystemClock(), OPENERS)
        return
    with BRICKS[name]() as opener:
        yield opener
