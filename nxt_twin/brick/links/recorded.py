"""A brick that does again what a recording says: it answers as the one that was recorded, and takes as long."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, Final, final

import numpy as np

from firmware_protocol import (
    Command,
    GetBatteryLevel,
    GetInputValues,
    GetOutputState,
    LowSpeedGetStatus,
    LowSpeedRead,
    LowSpeedWrite,
    MotorMode,
    OutputPort,
    ReplyData,
    RunState,
    Status,
    blank_reply,
    decode_request,
    encode_reply,
)
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import LinkLostError, LinkTimeoutError
from nxt_twin.recording.columns import (
    BATTERY,
    DRIVE_MODES,
    PORTS,
    DriveMode,
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
from nxt_twin.recording.recording import Recording

_ASSUMED_V: Final = 8.0
_IDLE_S: Final = 0.01
"""How long an answer takes when the recording is over."""
_OUTPUTS: Final[dict[int, Port]] = {OutputPort.A: "a", OutputPort.B: "b", OutputPort.C: "c"}
_MODES: Final[dict[DriveMode, int]] = {
    "drive": MotorMode.ON | MotorMode.BRAKE,
    "float": MotorMode.ON,
    "coast": MotorMode.COAST,
    "brake": MotorMode.ON | MotorMode.BRAKE,
}


@final
class RecordedBrick:
    """A link to a brick that was recorded, and what commanded its motors then.

    The first motor that is read a second time moves it to the next row. It waits for that row's time by the clock,
    and then all motors answer with that row's counts. A host that polls all motors in turn sees every row once.
    It accepts commands, and they change nothing. It stays at its last row.

    Args:
        recording: of a brick (docs/formats.md#recordings).
        clock: by which its rows come; the first at the moment of the first question.

    Attributes:
        row: which row it is at; -1 before the first.
    """

    def __init__(self, recording: Recording, clock: Clock) -> None:
        self._columns = recording.columns
        self._sampled = {
            name: np.flatnonzero(~np.isnan(values)) for name, values in recording.columns.items()
        }
        self._time_s = recording.time_s - recording.time_s[0]
        self._name = recording.name
        self._clock = clock
        self._began_s: float | None = None
        self._asked: set[Port] = set()
        self._replies: deque[bytes] = deque()
        self._given: dict[str, int] = {}
        self._open = True
        self.row = -1
        self._answers: dict[type[Command[Any]], Callable[[Any], ReplyData | Status]] = {
            GetOutputState: self._motor,
            GetInputValues: self._sensor,
            GetBatteryLevel: self._battery,
            LowSpeedWrite: self._begin_echo,
            LowSpeedGetStatus: self._waiting,
            LowSpeedRead: self._echo,
        }

    @property
    def duration_s(self) -> float:
        """From the first row to the last, s."""
        return float(self._time_s[-1])

    @property
    def ports(self) -> tuple[Port, ...]:
        """The motors that were recorded."""
        return tuple(port for port in PORTS if tacho_column(port) in self._columns)

    def told(self, port: Port) -> tuple[int, DriveMode]:
        """What that motor was commanded in the row that it is at."""
        row = max(self.row, 0)
        power = self._columns.get(power_column(port))
        mode = self._columns.get(mode_column(port))
        power_pct = 0.0 if power is None else power[row]
        return int(power_pct), "drive" if mode is None else DRIVE_MODES[int(mode[row])]

    def send(self, telegram: bytes) -> None:
        """Take one request."""
        self._check()
        request, reply_required = decode_request(telegram)
        answer = self._answers.get(type(request))
        said = blank_reply(request) if answer is None else answer(request)
        if not reply_required:
            return
        status = said if isinstance(said, Status) else Status.OK
        data = blank_reply(request) if isinstance(said, Status) else said
        self._replies.append(encode_reply(type(request), data, status=status))

    def receive(self, timeout_s: float) -> bytes:
        """Give the answer."""
        self._check()
        if not self._replies:
            self._clock.sleep(timeout_s)
            raise LinkTimeoutError("a recording says nothing by itself", where=self.describe())
        return self._replies.popleft()

    def close(self) -> None:
        """Let go of it."""
        self._open = False

    def describe(self) -> str:
        """Which recording it is."""
        return f"replay of {self._name}"

    def _check(self) -> None:
        if not self._open:
            raise LinkLostError("the link was closed", where=self.describe())

    def _motor(self, request: GetOutputState) -> ReplyData | Status:
        port = _OUTPUTS.get(request.port)
        if port is None:
            return Status.BAD_ARGUMENT
        if not self._asked or port in self._asked:
            self._advance()
        self._asked.add(port)
        power_pct, mode = self.told(port)
        count = round(self._latest(tacho_column(port), 0.0))
        running = RunState.IDLE if mode == "coast" else RunState.RUNNING
        return GetOutputState.Reply(
            port=request.port,
            power=power_pct,
            mode=_MODES[mode],
            regulation=0,
            turn_ratio=0,
            run_state=running,
            tacho_limit=0,
            tacho_count=count,
            block_tacho_count=count,
            rotation_count=count,
        )

    def _advance(self) -> None:
        self._asked.clear()
        now_s = self._clock.now_s()
        if self._began_s is None:
            self._began_s = now_s
        if self.row + 1 >= self._time_s.size:
            self._clock.sleep(_IDLE_S)
            return
        self.row += 1
        due_s = self._began_s + float(self._time_s[self.row])
        self._clock.sleep(max(due_s - now_s, 0.0))

    def _sensor(self, request: GetInputValues) -> ReplyData:
        slot = self._slot(request.port)
        touch = self._fresh(touch_column(slot))
        raw = next((self._fresh(name(slot)) for name in (light_column, sound_column)
                    if name(slot) in self._columns), None)  # fmt: skip
        value = raw if touch is None else touch
        number = 0 if value is None else round(value)
        return GetInputValues.Reply(
            port=request.port,
            valid=value is not None,
            calibrated=False,
            sensor_type=0,
            sensor_mode=0,
            raw=number,
            normalised=number,
            scaled=number,
            calibrated_value=number,
        )

    def _begin_echo(self, request: LowSpeedWrite) -> ReplyData | Status:
        known = ultrasonic_column(self._slot(request.port)) in self._columns
        return blank_reply(request) if known else Status.BUS_ERROR

    def _waiting(self, request: LowSpeedGetStatus) -> ReplyData:
        place = self._fresh_place(ultrasonic_column(self._slot(request.port)))
        return LowSpeedGetStatus.Reply(bytes_ready=0 if place is None else 1)

    def _echo(self, request: LowSpeedRead) -> ReplyData | Status:
        distance_cm = self._fresh(ultrasonic_column(self._slot(request.port)))
        if distance_cm is None:
            return Status.PENDING
        return LowSpeedRead.Reply.of(bytes((round(distance_cm),)))

    def _battery(self, request: GetBatteryLevel) -> ReplyData:
        del request
        return GetBatteryLevel.Reply(round(1000.0 * self._latest(BATTERY, _ASSUMED_V)))

    def _slot(self, port: int) -> SensorSlot:
        slots: tuple[SensorSlot, ...] = (1, 2, 3, 4)
        return slots[port % len(slots)]

    def _latest(self, name: str, otherwise: float) -> float:
        """The last sample up to the row that it is at; before the first, the first."""
        sampled = self._sampled.get(name)
        if sampled is None or sampled.size == 0:
            return otherwise
        at = max(int(np.searchsorted(sampled, self.row, side="right")) - 1, 0)
        return float(self._columns[name][sampled[at]])

    def _fresh(self, name: str) -> float | None:
        """The last sample up to the row that it is at, if it was not given before."""
        place = self._fresh_place(name)
        if place is None:
            return None
        self._given[name] = place
        return float(self._columns[name][place])

    def _fresh_place(self, name: str) -> int | None:
        """The row of that sample; the sample is not given by asking."""
        sampled = self._sampled.get(name)
        at = -1 if sampled is None else int(np.searchsorted(sampled, self.row, side="right")) - 1
        if sampled is None or at < 0:
            return None
        place = int(sampled[at])
        return None if self._given.get(name) == place else place


@final
class RecordedCommands:
    """The commands of a recorded brick's motors, each at its own time.

    Args:
        brick: in whose rows the commands stand.
        ports: the motors that are of interest; all that were recorded by default.
    """

    def __init__(self, brick: RecordedBrick, ports: tuple[Port, ...] | None = None) -> None:
        self._brick = brick
        self._ports = brick.ports if ports is None else ports

    @property
    def ports(self) -> tuple[Port, ...]:
        """The motors that are of interest."""
        return self._ports

    def at(self, time_s: float, counts: Mapping[Port, int]) -> Mapping[Port, tuple[int, DriveMode]]:
        """The commands of the row that the brick is at; none before the first."""
        del time_s, counts
        return {} if self._brick.row < 0 else {port: self._brick.told(port) for port in self.ports}
