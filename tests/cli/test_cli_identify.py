"""An experiment on a brick at the other end of a link, told to end while the motor turns."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

from nxt_twin.brick.clock import SystemClock
from nxt_twin.brick.open import open_brick

PROGRAM = (sys.executable, "-c", "from nxt_twin.cli import main; main()")


@contextmanager
def served_brick():
    command = [*PROGRAM, "mock", "--tcp", "127.0.0.1:0", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            (url,) = json.loads(process.stdout.readline())["urls"]
            yield url
        finally:
            process.terminate()


def _motor(url):
    with open_brick(url, SystemClock()) as brick:
        return brick.motors.read(0).value


def _turning(part):
    return part.exists() and part.read_text().count(",drive,") > 20


def test_an_experiment_that_is_told_to_end_lets_the_motor_go(tmp_path):
    out = tmp_path / "run"
    part = out / "recordings" / "bare-step-100.csv.part"
    with served_brick() as url:
        command = [*PROGRAM, "identify", "motor_steps", url, "--out", str(out)]
        with subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        ) as process:
            while not _turning(part):
                assert process.poll() is None
                time.sleep(0.05)
            process.send_signal(signal.SIGTERM)
            _, err = process.communicate()
        assert process.returncode == 1
        assert err.splitlines()[-1] == "nxt-twin: interrupted"
        motor = _motor(url)
    assert (motor.power_pct, motor.mode) == (0, 0)
    assert motor.tacho_deg > 20
    assert {path.name for path in part.parent.iterdir()} == {part.name}
