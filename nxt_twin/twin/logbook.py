"""A brick without a model: polled, driven if wanted, and written down as docs/formats.md#recordings says."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import BrickError
from nxt_twin.recording.columns import (
    BATTERY,
    DRIVE_MODES,
    TIME,
    Port,
    SensorSlot,
    light_column,
    mode_column,
    power_column,
    sound_column,
    tacho_column,
    touch_column,
    ultrasonic_column,
)
from nxt_twin.twin.dating import Dating
from nxt_twin.twin.driver import Driver, Told
from nxt_twin.twin.history import Recorder
from nxt_twin.twin.polling import OUTPUTS, Plan, SensorPoll, reported, tell
from nxt_twin.twin.settings import Pace

if TYPE_CHECKING:
    # Brings in the filters, which nobody needs who only polls.
    from nxt_twin.twin.sensor_twin import PortSensor

_COLUMNS: Final[Mapping[PortSensor, Callable[[SensorSlot], str]]] = {
    "touch": touch_column,
    "light": light_column,
    "sound": sound_column,
    "ultrasonic": ultrasonic_column,
}


@final
@dataclass(frozen=True)
class Beat:
    """How far it is.

    Attributes:
        elapsed_s: since the first poll.
        rows: written so far.
    """

    elapsed_s: float
    rows: int


TellBeat = Callable[[Beat], None]


def columns_to_fill(ports: tuple[Port, ...], sensors: Mapping[SensorSlot, PortSensor]) -> tuple[str, ...]:
    """The columns that rows of these motors and sensors may fill."""
    motors = [name(port) for port in ports for name in (power_column, mode_column, tacho_column)]
    return (TIME, *motors, BATTERY, *(_COLUMNS[kind](slot) for slot, kind in sensors.items()))


@final
class Logbook:
    """Polls one brick and writes every poll down.

    In a poll the battery and a sensor come first, if due, then the motors; the row's stamp is that of the last reply.
    Only then are the motors commanded: so a command acts after the counts that stand in its row. By how much both are
    off its stamp is learnt meanwhile.

    Args:
        brick: open.
        clock: of all stamps.
        ports: motors to read.
        plan: what else is asked, and how often.
        recorder: keeps the rows; None keeps none.
        driver: commands the motors; None leaves that to somebody else, and the brick's word is taken for it.
        pace: when, between request and reply, the brick acts.

    Attributes:
        rows: the number of rows that were written.
        row_lags: by how much what is in a row is off its stamp.
    """

    def __init__(
        self,
        brick: Brick,
        clock: Clock,
        ports: tuple[Port, ...],
        plan: Plan,
        recorder: Recorder | None = None,
        driver: Driver | None = None,
        pace: Pace | None = None,
    ) -> None:
        self._brick, self._clock, self._ports, self._plan = brick, clock, ports, plan
        self._recorder, self._driver = recorder, driver
        self._sensors = SensorPoll(brick, plan)
        self._told: dict[Port, Told] = {}
        self._counts: dict[Port, int] = {}
        self._battery_due_s = 0.0
        self._began_s = 0.0
        self._dating = Dating(pace or Pace())
        self.rows = 0
        self.row_lags = self._dating.row_lags

    @property
    def _now_s(self) -> float:
        return self._clock.now_s() - self._began_s

    def keep(self, seconds: float | None, report: TellBeat = lambda _: None) -> Beat:
        """Poll for so long, or until interrupted; whatever ends it, driven motors coast.

        Args:
            seconds: how long; None for ever.
            report: is told after each poll.

        Returns:
            How far it came.

        Raises:
            BrickError: the brick does not answer.
            RecordingError: the recorder failed.
        """
        self._sensors.set_up()
        self._began_s = self._clock.now_s()
        beat = Beat(0.0, self.rows)
        try:
            while seconds is None or self._now_s < seconds:
                began_s = self._now_s
                self._poll(seconds)
                beat = Beat(self._now_s, self.rows)
                report(beat)
                self._clock.sleep(max(began_s + self._plan.period_s - self._now_s, 0.0))
        finally:
            if self._driver is not None:
                with suppress(BrickError):  # the link is lost, which the error that is on its way tells
                    self._brick.motors.coast()
        return beat

    def _poll(self, seconds: float | None) -> None:
        row: dict[str, float] = {}
        self._read_battery(row)
        self._read_sensor(row)
        received_s = self._now_s
        for port in self._ports:
            reply = self._brick.motors.read(OUTPUTS[port])
            self._dating.count(port, reply)
            received_s = reply.received_s - self._began_s
            self._counts[port] = reply.value.tacho_deg
            row[tacho_column(port)] = float(reply.value.tacho_deg)
            if self._driver is None or port not in self._driver.ports:
                self._told[port] = reported(reply.value)
        self._dating.row(self._began_s + received_s)
        try:
            if self._driver is not None and (seconds is None or received_s < seconds):
                self._command(self._driver, received_s)
        finally:  # what was read is kept, whether or not the brick answers a command
            self._put_down(received_s, row)

    def _put_down(self, received_s: float, row: dict[str, float]) -> None:
        for port in self._ports:
            power_pct, mode = self._told.get(port, (0, "coast"))
            row[power_column(port)] = float(power_pct)
            row[mode_column(port)] = float(DRIVE_MODES.index(mode))
        self.rows += 1
        if self._recorder is not None:
            self._recorder.row({TIME: round(received_s, 6), **row})

    def _command(self, driver: Driver, now_s: float) -> None:
        for port, told in driver.at(now_s, self._counts).items():
            if self._told.get(port) != told:
                self._told[port] = told
                reply = tell(self._brick, port, *told)
                self._dating.command(port, reply, self._began_s + now_s)

    def _read_battery(self, row: dict[str, float]) -> None:
        if self._now_s >= self._battery_due_s:
            self._battery_due_s = self._now_s + self._plan.battery_every_s
            row[BATTERY] = self._brick.device.battery_v().value

    def _read_sensor(self, row: dict[str, float]) -> None:
        found = self._sensors.next(self._now_s)
        if found is not None:
            slot, reply = found
            row[_COLUMNS[self._plan.sensors[slot]](slot)] = reply.value
