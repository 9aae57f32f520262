"""The plugin in a test suite of somebody's own, in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import platformdirs
import pytest

pytest_plugins = ["pytester"]

EXAMPLE = Path(__file__).parents[2] / "examples" / "ci"
CACHE = os.environ.get("NXT_TWIN_CACHE") or platformdirs.user_cache_dir("nxt-twin")
"""Asked for here, since pytester moves the user's home."""
PLUGIN = ("-p", "nxt_twin.testing.plugin")


@pytest.fixture
def suite(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    monkeypatch.setenv("NXT_TWIN_CACHE", CACHE)
    pytester.makeini("[pytest]\naddopts = --strict-markers\n")
    return pytester


def run(suite: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    return suite.runpytest_subprocess(*PLUGIN, *arguments)


def test_whoever_does_not_use_it_pays_nothing():
    code = (
        "import sys, pytest; before = set(sys.modules); import nxt_twin.testing.plugin;"
        "print(*sorted(set(sys.modules) - before))"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert [name for name in loaded if not name.startswith("nxt_twin.testing") and name != "nxt_twin"] == []


def test_the_product_imports_no_pytest():
    code = (
        "import sys, nxt_twin.cli.app, nxt_twin.testing.bench, nxt_twin.testing.conformance;"
        "print('pytest' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said == "False\n"


def test_fixtures_and_markers_do_what_they_say_and_wrong_ones_are_one_line(suite):
    suite.path.joinpath("rover.yaml").write_text("name: Rover\nsensors:\n  1: {kind: touch, pressed: 1}\n")
    suite.makepyfile(
        """
        import pytest
        from firmware_protocol import InputPort, SensorMode, SensorType
        from nxt_twin.brick.errors import LinkLostError

        def touched(brick):
            brick.sensors.set_mode(InputPort.S1, SensorType.SWITCH, SensorMode.BOOLEAN)
            return brick.sensors.read_valid(InputPort.S1).value.scaled

        def test_a_world_can_be_set_while_the_test_runs(nxt_bench, nxt_brick):
            assert nxt_brick is nxt_bench.brick
            assert touched(nxt_brick) == 0
            nxt_bench.body.sensors[0].pressed.set(1)
            nxt_bench.wait(0.1)
            assert touched(nxt_brick) == 1

        @pytest.mark.nxt_world("rover.yaml")
        def test_a_world_comes_from_a_file(nxt_brick):
            assert nxt_brick.device.info().value.name == "Rover"
            assert touched(nxt_brick) == 1

        @pytest.mark.nxt_world(name="Inline", battery={"voltage_v": 6.5})
        def test_a_world_comes_from_keys(nxt_brick):
            assert nxt_brick.device.info().value.name == "Inline"
            assert nxt_brick.device.battery_v().value < 6.6

        def slowest_s(brick):
            replies = [brick.device.battery_v() for _ in range(20)]
            return max(reply.received_s - reply.sent_s for reply in replies)

        @pytest.mark.nxt_latency("bluetooth")
        def test_a_link_is_slow(nxt_brick):
            assert 0.03 < slowest_s(nxt_brick) < 0.08

        @pytest.mark.nxt_latency(to_brick_ms=100)
        def test_a_delay_is_set_by_itself(nxt_brick):
            assert 0.1 < slowest_s(nxt_brick) < 0.11

        @pytest.mark.nxt_faults(silent=4)
        def test_a_sensor_is_silent(nxt_brick):
            nxt_brick.sensors.set_mode(InputPort.S4, SensorType.LOW_SPEED_9V, SensorMode.RAW)
            nxt_brick.sensors.read_valid(InputPort.S1)
            with pytest.raises(Exception, match="LS_|sensor|bus"):
                nxt_brick.ultrasonic.set_up(InputPort.S4)
                nxt_brick.ultrasonic.distance_cm(InputPort.S4)

        def test_the_brick_is_switched_off(nxt_bench, nxt_brick):
            nxt_bench.firmware.switch_off()
            with pytest.raises(LinkLostError):
                nxt_brick.device.battery_v()
        """
    )
    suite.makepyfile(
        test_wrong="""
        import pytest

        @pytest.mark.nxt_world("missing.yaml")
        def test_world(nxt_brick): ...

        @pytest.mark.nxt_world(nome="Rover")
        def test_key(nxt_brick): ...

        @pytest.mark.nxt_latency("carrier pigeon")
        def test_latency(nxt_brick): ...

        @pytest.mark.nxt_faults(drp=0.1)
        def test_fault(nxt_brick): ...

        @pytest.mark.nxt_faults(silent=1)
        def test_port(nxt_mock): ...
        """
    )
    result = run(suite, "-q")
    result.assert_outcomes(passed=7, errors=5)
    told = (
        "*missing.yaml*",
        "*key nome: unknown key*",
        "*carrier pigeon*",
        "*there is no drp*",
        "*no digital sensor*",
    )
    result.stdout.fnmatch_lines(told)
    assert "Traceback" not in result.stdout.str()


def test_the_example_for_continuous_integration_passes(suite):
    for name in ("robot.py", "test_robot.py"):
        suite.path.joinpath(name).write_text(EXAMPLE.joinpath(name).read_text())
    run(suite, "-q").assert_outcomes(passed=4)
