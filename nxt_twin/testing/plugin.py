"""The pytest plugin: mock bricks as fixtures. It imports nothing until a test asks for one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    from nxt_twin.brick.brick import Brick
    from nxt_twin.testing.bench import MockBench, ServedMock
    from nxt_twin.testing.settings import MockSettings

_MARKERS: Final = (
    'nxt_world(file, **keys): the mock brick\'s world: a file beside the test, or its keys, such as name="Rover"',
    'nxt_latency(profile, **delays): the link\'s delays: "none", "usb" or "bluetooth", or ms, such as to_brick_ms=8',
    "nxt_faults(drop, corrupt, silent, absent, seed): the mock brick's faults: lost and changed bytes, dead sensors",
)


def pytest_configure(config: pytest.Config) -> None:
    """Declare the markers."""
    for marker in _MARKERS:
        config.addinivalue_line("markers", marker)


@pytest.fixture
def nxt_bench(request: pytest.FixtureRequest) -> Iterator[MockBench]:
    """A mock brick in virtual time, with the client connected to it and the body within reach."""
    from nxt_twin.testing.bench import open_bench

    with _told(), open_bench(_settings(request)) as bench:
        yield bench


@pytest.fixture
def nxt_brick(nxt_bench: MockBench) -> Brick:
    """nxt-twin's typed client, connected to a mock brick in virtual time."""
    return nxt_bench.brick


@pytest.fixture
def nxt_mock(request: pytest.FixtureRequest) -> Iterator[ServedMock]:
    """A mock brick in real time, at a pseudo-terminal and over TCP, for any client."""
    from nxt_twin.testing.bench import serve_mock

    scratch = request.getfixturevalue("tmp_path_factory").mktemp("nxt_mock")
    with _told(), serve_mock(_settings(request), scratch) as served:
        yield served


def _settings(request: pytest.FixtureRequest) -> MockSettings:
    """What the test's markers ask for; of two alike, the nearest counts."""
    from nxt_twin.testing.settings import MockSettings, with_faults, with_latency, with_world

    node = request.node
    settings = MockSettings()
    if (world := node.get_closest_marker("nxt_world")) is not None:
        file = world.args[0] if world.args else None
        scratch = request.getfixturevalue("tmp_path_factory").mktemp("nxt_world")
        settings = with_world(settings, file, world.kwargs, here=node.path.parent, scratch=scratch)
    if (latency := node.get_closest_marker("nxt_latency")) is not None:
        settings = with_latency(settings, latency.args[0] if latency.args else "none", latency.kwargs)
    if (faults := node.get_closest_marker("nxt_faults")) is not None:
        settings = with_faults(settings, faults.kwargs)
    return settings


@contextmanager
def _told() -> Iterator[None]:
    """What the user can mend becomes one line; what a test itself raises does not pass here."""
    from nxt_twin.errors import NxtTwinError

    told = ""
    try:
        yield
    except NxtTwinError as error:
        told = str(error)
    if told:  # outside of the handler, so that pytest does not print the line twice
        pytest.fail(told, pytrace=False)
