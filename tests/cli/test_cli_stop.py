"""Whoever ends the program, and however: the motors coast; and where they cannot, the user is told what ends it."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import pytest
from cli_program import column, run, succeed

from firmware_protocol import OutputPort
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick, open_link
from nxt_twin.brick.portrait import driven
from nxt_twin.cli.wanted import tidy_end
from nxt_twin.mock.run import serve
from nxt_twin.recording.stream import RecordingWriter, stream_path

PROGRAM = [sys.executable, "-c", "from nxt_twin.cli import main; main()"]
STEADY = """
kind: motor_program
name: Steady
runs: [{name: one, segments: [{duration_s: 600, power_pct: 60}]}]
"""
SIGNALS = ["SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGALRM", "SIGVTALRM", "SIGPROF", "SIGXCPU", "SIGHUP"]


@contextmanager
def served():
    """The URL of a mock brick that is served meanwhile."""
    known, over = threading.Event(), threading.Event()
    urls = []

    def announce(place):
        urls.extend(place.urls)
        known.set()

    keys = {"clock": SystemClock(), "announce": announce, "tcp": "127.0.0.1:0", "stop": over.is_set}
    server = threading.Thread(target=serve, kwargs=keys)
    server.start()
    assert known.wait(60)
    try:
        yield urls[0]
    finally:
        over.set()
        server.join()


def left_driving(url, power_pct=60):
    """Drive motor B and go away without a word, as a program does that is killed."""
    link = open_link(url, SystemClock())
    Brick(link, SystemClock()).motors.drive(OutputPort.B, power_pct)
    link.close()


@pytest.fixture(scope="module")
def brick_url():
    with served() as url:
        yield url


@pytest.mark.skipif(os.name == "nt", reason="Windows has none of these signals")
@pytest.mark.parametrize("name", SIGNALS)
def test_every_signal_that_can_be_heeded_is_taken_for_an_interrupt(name):
    with pytest.raises(KeyboardInterrupt), tidy_end():
        signal.raise_signal(getattr(signal, name))


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signal")
def test_a_signal_that_ends_a_drive_lets_the_motors_coast(brick_url, tmp_path):
    program, out = tmp_path / "p.yaml", tmp_path / "r.csv"
    program.write_text(STEADY)
    command = [*PROGRAM, "record", brick_url, "--out", str(out), "--ports", "a", "--program", str(program)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        while not (stream_path(out).exists() and stream_path(out).stat().st_size > 2000):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGQUIT)
        _, err = process.communicate()
    assert (process.returncode, err) == (0, "")
    assert column(out, "a_power_pct").max() == 60.0
    with open_brick(brick_url, SystemClock()) as brick:
        assert driven(brick) == {}


def test_a_brick_that_was_left_driving_is_told_and_stopped(brick_url):
    left_driving(brick_url)
    found = succeed("connect", brick_url)
    assert f"the brick drives B at 60 %; nxt-twin stop {brick_url} lets its motors coast" in found.err
    stopped = succeed("stop", brick_url, "--json").json()
    assert stopped == {"schema": "nxt-twin/stop/1", "program": None, "driven": {"B": 60}}
    assert succeed("connect", brick_url).err == ""
    assert succeed("stop", brick_url).out == "all motors coast; driven before: none\n"


def test_stop_cannot_stop_what_it_cannot_reach():
    assert run("stop", "tcp:127.0.0.1:9").status == 1
    assert run("stop", "nowhere:").status == 2


@pytest.mark.parametrize(("power_pct", "mode", "told"), [(60, 0, True), (60, 2, False), (0, 0, False)])
def test_recover_says_that_motors_may_turn(tmp_path, power_pct, mode, told):
    path = tmp_path / "run.csv"
    with RecordingWriter(path, ("time_s", "a_power_pct", "a_mode", "a_tacho_deg")) as writer:
        for number in range(3):
            row = {"time_s": 0.1 * number, "a_tacho_deg": 0.0}
            writer.row({**row, "a_power_pct": float(power_pct), "a_mode": float(mode)})
        (tmp_path / "cut.csv.stream").write_bytes(stream_path(path).read_bytes())
    outcome = succeed("recover", tmp_path / "cut.csv", "--json", tmp_path / "told.json")
    assert ("the last row drives A at 60 %" in outcome.err) == told
    assert json.loads((tmp_path / "told.json").read_text())["driven"] == ({"a": 60.0} if told else {})
