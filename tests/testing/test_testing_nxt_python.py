"""nxt-python's own programs and examples, unchanged, on the plugin's mock brick.

Its documentation's examples and its commands come with the package. Its example scripts do not: name their folder by
``NXT_PYTHON_EXAMPLES`` (``examples`` of a checkout of github.com/schodet/nxt-python) to have them run too.
"""

from __future__ import annotations

import doctest
import gc
import os
import signal
import subprocess
import sys
from pathlib import Path

import nxt.backend.devfile
import nxt.locator
import pytest

pytest_plugins = ["nxt_twin.testing.plugin"]

EXAMPLES = os.environ.get("NXT_PYTHON_EXAMPLES", "")
ENDLESS = ("sensors.py", "tutorial/sensor_touch.py", "tutorial/sensor_us.py")
"""These read until they are interrupted."""
WITHIN_S = 30.0


@pytest.fixture
def folder(tmp_path, nxt_mock):
    """Where nxt-python finds the mock brick by its own configuration file."""
    tmp_path.joinpath(".nxt-python.conf").write_text(nxt_mock.nxt_python_config)
    return tmp_path


def said(folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=WITHIN_S,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


class Here:
    """A backend that finds the mock brick, in the place where nxt-python's own doctests put theirs."""

    def __init__(self, device: Path) -> None:
        self._device = str(device)

    def find(self, **filters):
        del filters
        return nxt.backend.devfile.Backend().find(filename=self._device)


class AnyOutput(doctest.OutputChecker):
    """The documentation leaves printed values out; an exception is still a failure."""

    def check_output(self, want, got, optionflags):
        del want, got, optionflags
        return True


def test_its_documentations_examples_run(nxt_mock, monkeypatch):
    monkeypatch.setattr(nxt.locator, "_get_default_backends", lambda **_: [Here(nxt_mock.device)])
    monkeypatch.setattr(sys, "argv", ["example"])
    runner = doctest.DocTestRunner(checker=AnyOutput())
    for example in doctest.DocTestFinder().find(nxt.locator):
        runner.run(example)
    assert runner.summarize(verbose=False) == doctest.TestResults(failed=0, attempted=11)
    gc.collect()  # the examples leave their bricks open


def test_its_commands_find_the_brick_by_its_configuration_file(folder):
    text = said(folder, "-m", "nxt.command.test")
    assert "NXT brick name: NXT" in text
    assert "Firmware version 1.29" in text
    assert "Play test sound...done." in text
    folder.joinpath("hello.txt").write_bytes(bytes(range(200)))
    said(folder, "-m", "nxt.command.push", "hello.txt")
    assert "('hello.txt', 200)" in said(folder, "-c", LIST)


LIST = "import nxt.locator; print(*nxt.locator.find().find_files('*.*'))"


@pytest.mark.skipif(not EXAMPLES, reason="NXT_PYTHON_EXAMPLES names no folder")
@pytest.mark.parametrize(
    "script", ["tutorial/find.py", "tutorial/debug.py", "tutorial/motor.py", "stop_turning_motor.py"]
)
def test_its_examples_run_to_their_end(folder, nxt_mock, script):
    said(folder, str(Path(EXAMPLES, script).resolve()))
    if "motor" in script:
        assert nxt_mock.body.motors.angles_rad()[0] != 0.0


@pytest.mark.skipif(not EXAMPLES, reason="NXT_PYTHON_EXAMPLES names no folder")
@pytest.mark.parametrize("script", ENDLESS)
def test_its_examples_read_until_interrupted(folder, nxt_mock, script):
    nxt_mock.body.sensors[0].pressed.set(1)
    command = [sys.executable, "-u", str(Path(EXAMPLES, script).resolve())]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as run:
        lines = iter(run.stdout.readline, "")
        seen = next(line for line in lines if line.strip()[:1] in tuple("[TF0123456789"))
        run.send_signal(signal.SIGINT)
    assert {"sensors.py": "True", "tutorial/sensor_touch.py": "True", "tutorial/sensor_us.py": "60"}[
        script
    ] in seen
