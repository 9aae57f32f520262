"""Options of the command line, which pytest only takes from here when no folder is named; no test is timed."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import hypothesis
import pytest

from nxt_twin.recording.realdata import DATA_VARIABLE
from nxt_twin.threads import one_of_many

_REAL = f"a real recording: `make real`, or set {DATA_VARIABLE}"
_SLOW = "slow: `make slow`"
_LEFT_OUT = {
    _REAL: "tests of real recordings were left out; `make real` runs them",
    _SLOW: "slow tests were left out; `make slow` runs them",
}

# Matrices are small here: a second thread of BLAS only waits in a loop, a third of a diagnosis' processor time.
os.environ.setdefault("OMP_NUM_THREADS", "1")

hypothesis.settings.register_profile("untimed", deadline=None)
hypothesis.settings.load_profile("untimed")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--quick", action="store_true", help="leave out the tests that are marked slow")
    parser.addoption(
        "--brick",
        metavar="URL",
        default=None,
        help="check this brick: motors turn for a moment; the ultrasonic sensor has to be on port 4",
    )


@pytest.fixture(scope="session", autouse=True)
def _no_power_cut() -> Iterator[None]:
    """No test pulls the plug, so none waits until the disk has what this process wrote."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda _: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def _abreast(request: pytest.FixtureRequest) -> Iterator[None]:
    """Where several workers share the cores, each simulates in its one thread."""
    with one_of_many() if hasattr(request.config, "workerinput") else nullcontext():
        yield


@pytest.fixture
def one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let each set of parameters run alone: to run them abreast takes 10 s to compile for each kind of plant.

    `tests/physics/test_physics_abreast.py` shows that sets abreast run as alone.
    """
    monkeypatch.setattr("nxt_twin.physics.simulate.FEWEST", sys.maxsize)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Before the workers of a whole run start, compile once what each of them would compile for itself."""
    config = session.config
    whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    if whole and config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        _compile_ahead()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out real recordings, which few people have, unless they are named; and slow tests if asked to."""
    _mark_slow_variants(items)
    left_out = {} if os.environ.get(DATA_VARIABLE) else {"real_data": _REAL}
    if config.getoption("--quick"):
        left_out["slow"] = _SLOW
    for item in items:
        for name, reason in left_out.items():
            if item.get_closest_marker(name):
                item.add_marker(pytest.mark.skip(reason=reason))


def _mark_slow_variants(items: list[pytest.Item]) -> None:
    """Give all but the first quick set of parameters of a test marked `slow_variants` the mark `slow`."""
    begun: set[str] = set()
    for item in items:
        if not item.get_closest_marker("slow_variants") or item.get_closest_marker("slow"):
            continue
        name = item.nodeid.partition("[")[0]
        if name in begun:
            item.add_marker(pytest.mark.slow)
        begun.add(name)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> Iterator[None]:
    """Say in the last lines how many were left out, and which commands run them."""
    yield
    skipped = [str(report.longrepr) for report in terminalreporter.stats.get("skipped", [])]
    for reason, said in _LEFT_OUT.items():
        if count := sum(reason in text for text in skipped):
            terminalreporter.write_line(f"{count} {said}")


def pytest_collection_finish() -> None:
    """What is imported and collected stays: the collector of garbage need not walk through it again and again."""
    gc.collect()
    gc.freeze()


def _compile_ahead() -> None:
    from nxt_twin.physics.kernel import is_compiled
    from nxt_twin.physics.layout import layout

    if is_compiled(layout("dc_motor", "motor")):
        return
    program = [sys.executable, str(Path(__file__).parent / "compiled_ahead.py")]
    for half in [subprocess.Popen([*program, name]) for name in ("one", "other")]:
        half.wait()
