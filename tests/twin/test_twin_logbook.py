"""A brick that is written down without a model."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from firmware_protocol import RunState
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.errors import LinkLostError
from nxt_twin.mock.serve.clock import VirtualClock
from nxt_twin.mock.start import open_mock_link
from nxt_twin.recording.columns import DRIVE_MODES
from nxt_twin.recording.files import read_sidecar
from nxt_twin.recording.lags import KnownLags
from nxt_twin.recording.program import MotorProgram, Run, Segment
from nxt_twin.twin.driver import ProgramDriver
from nxt_twin.twin.logbook import Logbook, columns_to_fill
from nxt_twin.twin.polling import Plan, tell
from nxt_twin.twin.settings import PACES

SENSORS = {1: "touch", 2: "sound", 3: "light", 4: "ultrasonic"}


class Rows:
    def __init__(self) -> None:
        self.rows: list[Mapping[str, float]] = []

    def row(self, values: Mapping[str, float]) -> None:
        self.rows.append(values)

    def close(self) -> None:
        pass

    def column(self, name: str) -> np.ndarray:
        return np.array([row.get(name, np.nan) for row in self.rows])


def program(*segments: Segment, ports=("a",), most_turn_deg=None) -> MotorProgram:
    run = Run(name="r", segments=segments)
    return MotorProgram(name="p", ports=ports, runs=(run,), rest_s=0.2, most_turn_deg=most_turn_deg)


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock()


@pytest.fixture
def brick(clock):
    with Brick(open_mock_link(clock), clock) as brick:
        yield brick


def test_a_driven_motor_is_written_down_with_its_commands(brick, clock):
    rows = Rows()
    driver = ProgramDriver(program(Segment(duration_s=0.3), Segment(duration_s=0.5, power_pct=60)))
    beat = Logbook(brick, clock, ("a", "b"), Plan(period_s=0.01), rows, driver).keep(driver.duration_s)
    time_s, power, count = (rows.column(name) for name in ("time_s", "a_power_pct", "a_tacho_deg"))
    assert beat.rows == len(rows.rows) == pytest.approx(100, abs=3)
    assert np.all(np.diff(time_s) > 0)
    first = int(np.argmax(power == 60))
    assert 0.3 <= time_s[first] < 0.33
    assert count[first] == 0  # read before the command of its row acts
    assert count[-1] > 90
    assert DRIVE_MODES[int(rows.column("a_mode")[-1])] == "coast"
    assert not rows.column("b_tacho_deg").any()
    assert np.isfinite(rows.column("battery_v")).sum() == 1


def test_all_sensors_are_read_in_turn(brick, clock):
    rows = Rows()
    Logbook(brick, clock, ("a",), Plan(SENSORS, period_s=0.01), rows).keep(2.0)
    names = columns_to_fill(("a",), SENSORS)
    assert set(names) >= {name for row in rows.rows for name in row}
    for name in ("s1_touch", "s2_sound_raw", "s3_light_raw", "s4_ultrasonic_cm"):
        assert np.isfinite(rows.column(name)).sum() > 5, name


def test_without_a_driver_the_bricks_word_is_taken_for_the_commands(brick, clock):
    rows = Rows()
    brick.motors.drive(0, -35)
    Logbook(brick, clock, ("a",), Plan(period_s=0.01), rows).keep(0.2)
    assert rows.column("a_power_pct")[-1] == -35
    assert brick.motors.read(0).value.run_state == RunState.RUNNING


def test_a_motor_that_turned_too_far_coasts(brick, clock):
    driver = ProgramDriver(program(Segment(duration_s=3.0, power_pct=100), most_turn_deg=180))
    rows = Rows()
    Logbook(brick, clock, ("a",), Plan(period_s=0.01), rows, driver).keep(driver.duration_s)
    count = rows.column("a_tacho_deg")
    assert 180 < count[-1] < 700
    assert rows.column("a_power_pct")[-1] == 0


@pytest.mark.parametrize("failure", [KeyboardInterrupt, RuntimeError])
def test_whatever_ends_it_the_motors_coast(brick, clock, failure):
    driver = ProgramDriver(program(Segment(duration_s=5.0, power_pct=50), ports=("a", "b", "c")))

    def fail(beat) -> None:
        if beat.elapsed_s > 0.5:
            raise failure

    with pytest.raises(failure):
        Logbook(brick, clock, ("a",), Plan(), None, driver).keep(driver.duration_s, fail)
    for port in (0, 1, 2):
        state = brick.motors.read(port).value
        assert (state.mode, state.run_state) == (0, RunState.IDLE)


def test_a_lost_link_ends_it_with_the_rows_until_then(clock):
    link = open_mock_link(clock, lost=LinkLostError)
    brick, rows = Brick(link, clock), Rows()

    def lose(beat) -> None:
        if beat.rows == 20:
            link.close()

    driver = ProgramDriver(program(Segment(duration_s=5.0, power_pct=50)))
    with pytest.raises(LinkLostError):
        Logbook(brick, clock, ("a",), Plan(period_s=0.01), rows, driver).keep(5.0, lose)
    assert len(rows.rows) == 20
    brick.close()


class Steady:
    """Commands by the clock: each time that it is asked, what the time says, and when it was asked."""

    def __init__(self, *powers, every_s=0.25) -> None:
        self.ports = ("a",)
        self.asked_s: list[float] = []
        self._powers, self._every_s = powers, every_s

    def at(self, time_s, _):
        self.asked_s.append(time_s)
        return {"a": (self._powers[min(int(time_s / self._every_s), len(self._powers) - 1)], "drive")}


@pytest.fixture
def commands(monkeypatch):
    """The power of each command that goes to the brick."""
    sent: list[int] = []

    def noted(brick, port, power_pct, mode):
        sent.append(power_pct)
        return tell(brick, port, power_pct, mode)

    monkeypatch.setattr("nxt_twin.twin.logbook.tell", noted)
    return sent


def test_a_motor_is_commanded_when_the_command_changes_and_never_at_the_end(brick, clock, commands):
    driver, rows = Steady(40, 40, -30, 40), Rows()
    beat = Logbook(brick, clock, ("a", "b"), Plan(period_s=0.02), rows, driver).keep(0.9)
    assert commands == [40, -30, 40]
    assert max(driver.asked_s) < 0.9
    assert beat.elapsed_s == pytest.approx(0.9, abs=0.03)
    assert beat.rows == len(rows.rows)
    assert set(rows.column("b_power_pct")) == {0.0}
    assert {DRIVE_MODES[int(mode)] for mode in rows.column("b_mode")} == {"coast"}


@pytest.mark.parametrize("period_s", [0.02, 0.05])
def test_polls_are_a_period_apart_and_the_battery_is_read_when_it_is_due(brick, clock, period_s):
    rows = Rows()
    Logbook(brick, clock, ("a",), Plan(battery_every_s=0.5, period_s=period_s), rows).keep(1.9)
    time_s, battery = rows.column("time_s"), rows.column("battery_v")
    assert np.diff(time_s) == pytest.approx(period_s, abs=2e-3)
    assert time_s[np.isfinite(battery)] == pytest.approx([0.0, 0.5, 1.0, 1.5], abs=period_s + 5e-3)
    assert np.nanmean(battery) == pytest.approx(8.0, abs=1.5)


def test_without_an_end_it_goes_on_until_it_is_interrupted(brick, clock):
    rows, driver = Rows(), Steady(20)

    def interrupt(beat) -> None:
        if beat.elapsed_s > 0.5:
            raise KeyboardInterrupt

    logbook = Logbook(brick, clock, ("a",), Plan(period_s=0.02), rows, driver)
    with pytest.raises(KeyboardInterrupt):
        logbook.keep(None, interrupt)
    assert logbook.rows == len(rows.rows) > 20
    assert rows.column("a_power_pct")[-1] == 20.0


def test_without_a_driver_no_motor_is_told_to_coast(brick, clock):
    brick.motors.drive(0, 50)
    Logbook(brick, clock, ("a",), Plan(period_s=0.02)).keep(0.1)
    assert brick.motors.read(0).value.run_state == RunState.RUNNING


def test_stamps_have_microseconds_and_what_is_off_them_is_learnt(clock, tmp_path):
    rows = Rows()
    with Brick(open_mock_link(clock, profile="usb", seed=3), clock) as brick:
        clock.sleep(100.0)
        logbook = Logbook(brick, clock, ("a", "b"), Plan(period_s=0.02), rows, Steady(40, -40), PACES["usb"])
        logbook.keep(0.8)
    time_s = rows.column("time_s")
    assert 0.0 < time_s[0] < 0.05
    assert np.array_equal(time_s, np.round(time_s, 6))
    logbook.row_lags.write_beside(tmp_path / "run.csv")
    told = KnownLags(read_sidecar(tmp_path / "run.csv"))
    assert 0.05 > told.read_before_s("a")[0] > told.read_before_s("b")[0] > 0.0
    assert 0.0 < told.acted_after_s("a")[0] < 0.05


def test_a_poll_that_outlasts_its_period_is_followed_by_the_next(brick, clock, monkeypatch):
    asked_s, sleep = [], clock.sleep

    def slept(seconds):
        asked_s.append(seconds)
        sleep(seconds)

    monkeypatch.setattr(clock, "sleep", slept)
    Logbook(brick, clock, ("a",), Plan(period_s=1e-6), Rows()).keep(0.2)
    assert asked_s
    assert min(asked_s) >= 0.0
