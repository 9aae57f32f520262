"""The robot's program on a mock brick: no brick needed, nothing in robot.py changed."""

from __future__ import annotations

import nxt.backend.devfile
import pytest
import robot

from firmware_protocol import OutputPort


@pytest.fixture
def brick(nxt_mock):
    (found,) = nxt.backend.devfile.Backend().find(filename=str(nxt_mock.device))
    with found:
        yield found


def test_the_bumper_stops_it(brick, nxt_mock):
    nxt_mock.body.sensors[0].pressed.set(1)
    assert robot.drive_until_stopped(brick) == "bumper"


@pytest.mark.nxt_world(sensors={4: {"kind": "ultrasonic", "distance_cm": 12.0}})
def test_a_wall_stops_it(brick):
    assert robot.drive_until_stopped(brick) == "wall"


@pytest.mark.nxt_latency("bluetooth")
def test_it_gives_up_in_time_over_bluetooth(brick, nxt_mock):
    assert robot.drive_until_stopped(brick, timeout_s=0.5) == "timeout"
    assert nxt_mock.body.tacho_counts()[0] > 0


def test_a_motor_with_our_own_client_in_virtual_time(nxt_bench, nxt_brick):
    nxt_brick.motors.drive(OutputPort.B, 50)
    nxt_bench.wait(10.0)
    assert nxt_brick.motors.read(OutputPort.B).value.tacho_deg > 1_000
