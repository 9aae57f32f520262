"""A brick that does again what a recording says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import PacedClock
from nxt_twin.brick.errors import CommandRefusedError, LinkLostError
from nxt_twin.brick.links.recorded import RecordedBrick, RecordedCommands
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.recording.recording import Recording

NAN = float("nan")
COLUMNS = {
    "time_s": [5.0, 5.01, 5.03, 5.04],
    "a_power_pct": [0, 50, 50, 0],
    "a_mode": [2, 0, 0, 2],
    "a_tacho_deg": [7, 7, 9, 12],
    "b_tacho_deg": [0, -1, -2, -3],
    "battery_v": [8.1, NAN, NAN, 7.9],
    "s1_touch": [NAN, 1, NAN, 0],
    "s4_ultrasonic_cm": [33, NAN, NAN, 255],
}


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock()


@pytest.fixture
def link(clock) -> RecordedBrick:
    return RecordedBrick(
        Recording("r.csv", {name: np.array(values) for name, values in COLUMNS.items()}), clock
    )


def test_every_row_comes_once_and_at_its_time(link, clock):
    clock.sleep(3.0)
    brick = Brick(link, clock)
    seen = []
    for _ in range(4):
        counts = [brick.motors.tacho_deg(port) for port in (0, 1)]
        seen.append((*(reply.value for reply in counts), round(counts[0].received_s - 3.0, 6)))
    assert seen == [(7, 0, 0.0), (7, -1, 0.01), (9, -2, 0.03), (12, -3, 0.04)]
    assert link.ports == ("a", "b")
    assert link.duration_s == pytest.approx(0.04)


def test_after_the_last_row_it_stands_still_and_time_passes(link, clock):
    brick = Brick(link, clock)
    for _ in range(6):
        reply = brick.motors.read(0)
    assert reply.value.tacho_deg == 12
    assert clock.now_s() == pytest.approx(0.04 + 2 * 0.01)


def test_commands_are_told_in_the_row_in_which_they_stand(link, clock):
    brick, told = Brick(link, clock), RecordedCommands(link)
    assert told.at(0.0, {}) == {}
    seen = []
    for _ in range(4):
        brick.motors.read(0)
        seen.append(told.at(0.0, {})["a"])
    assert seen == [(0, "coast"), (50, "drive"), (50, "drive"), (0, "coast")]
    assert RecordedCommands(link, ("b",)).at(0.0, {}) == {"b": (0, "drive")}


def test_a_sample_is_given_once(link, clock):
    brick = Brick(link, clock)
    brick.motors.read(0)
    assert not brick.sensors.read(0).value.valid
    brick.motors.read(0)
    touched = brick.sensors.read(0).value
    assert (touched.valid, touched.scaled) == (True, 1)
    assert not brick.sensors.read(0).value.valid
    assert brick.low_speed.read(3).value == bytes((33,))
    with pytest.raises(CommandRefusedError):
        brick.low_speed.read(3)
    with pytest.raises(CommandRefusedError):
        brick.low_speed.write(1, b"\x02\x42", receive_length=1)


def test_the_battery_is_the_last_that_was_read(link, clock):
    brick = Brick(link, clock)
    voltages = []
    for _ in range(4):
        brick.motors.read(0)
        voltages.append(brick.device.battery_v().value)
    assert voltages == pytest.approx([8.1, 8.1, 8.1, 7.9])


def test_commands_change_nothing(link, clock):
    brick = Brick(link, clock)
    brick.motors.read(0)
    brick.motors.drive(0, 100)
    brick.close()
    assert brick.describe() == "replay of r.csv"
    with pytest.raises(LinkLostError):
        brick.motors.read(0)


def test_a_paced_clock_waits_for_nobody_who_is_late():
    own = VirtualClock()
    clock = PacedClock(own, 4.0)
    clock.sleep(2.0)
    assert (own.now_s(), clock.now_s()) == (0.5, 2.0)
    own.sleep(10.0)  # something took long
    assert clock.now_s() == 2.0
    clock.sleep(2.0)
    assert (own.now_s(), clock.now_s()) == (10.5, 4.0)


def test_a_clock_without_a_pace_is_at_once_there():
    own = VirtualClock()
    clock = PacedClock(own, math.inf)
    clock.sleep(3600.0)
    assert (own.now_s(), clock.now_s()) == (0.0, 3600.0)
