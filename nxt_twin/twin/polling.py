"""The requests of a poll: every motor, and of the rest those that are due."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, final

from firmware_protocol import MotorMode, OutputPort, RunState, SensorMode, SensorType
from firmware_protocol.ultrasonic import ADDRESS, UltrasonicRegister
from nxt_twin.brick.brick import Brick
from nxt_twin.brick.commands.motors import MotorState
from nxt_twin.brick.errors import CommandRefusedError
from nxt_twin.brick.stamped import Stamped
from nxt_twin.recording.columns import DriveMode, Port, SensorSlot

if TYPE_CHECKING:
    # Brings in the filters, which nobody needs who only polls.
    from nxt_twin.twin.sensor_twin import PortSensor

OUTPUTS: Mapping[Port, OutputPort] = {"a": OutputPort.A, "b": OutputPort.B, "c": OutputPort.C}
_TYPES = {
    "touch": (SensorType.SWITCH, SensorMode.BOOLEAN),
    "light": (SensorType.LIGHT_ACTIVE, SensorMode.RAW),
    "sound": (SensorType.SOUND_DB, SensorMode.RAW),
}
_FETCHES_MOST = 30


@final
@dataclass(frozen=True)
class Plan:
    """How often what is asked.

    Attributes:
        sensors: what is plugged in, by slot.
        sensor_every_s: how often each analogue sensor is read.
        ultrasonic_every_s: how often the ultrasonic sensor is; it pings about every 40 ms, a reading takes two polls.
        battery_every_s: how often the battery is.
        period_s: how long a poll takes at least; 0 is the link's own pace.
    """

    sensors: Mapping[SensorSlot, PortSensor] = field(default_factory=dict)
    sensor_every_s: float = 0.05
    ultrasonic_every_s: float = 0.075
    battery_every_s: float = 2.0
    period_s: float = 0.0


@final
class SensorPoll:
    """Asks one sensor a poll, in turn; a digital one is asked in one poll and fetched in a later one.

    Args:
        brick: whose.
        plan: what is plugged in, and how often.
    """

    def __init__(self, brick: Brick, plan: Plan) -> None:
        self._brick = brick
        self._plan = plan
        self._due_s = dict.fromkeys(plan.sensors, 0.0)
        self._fetching: SensorSlot | None = None
        self._fetches = 0

    def set_up(self) -> None:
        """Tell the brick what is plugged in."""
        for slot, kind in self._plan.sensors.items():
            if kind == "ultrasonic":
                self._brick.ultrasonic.set_up(slot - 1)
            else:
                sensor_type, mode = _TYPES[kind]
                self._brick.sensors.set_mode(slot - 1, sensor_type, mode)

    def next(self, now_s: float) -> tuple[SensorSlot, Stamped[float]] | None:
        """Ask for one reading; None where there is none in this poll."""
        if self._fetching is not None:
            return self._fetch(self._fetching)
        due = [slot for slot, due_s in self._due_s.items() if due_s <= now_s]
        if not due:
            return None
        slot = min(due, key=lambda each: self._due_s[each])
        if self._plan.sensors[slot] == "ultrasonic":
            self._due_s[slot] = now_s + self._plan.ultrasonic_every_s
            self._begin(slot)
            return None
        self._due_s[slot] = now_s + self._plan.sensor_every_s
        reading = self._brick.sensors.read(slot - 1)
        if not reading.value.valid:
            return None
        pressed = float(reading.value.scaled != 0)
        value = pressed if self._plan.sensors[slot] == "touch" else float(reading.value.raw)
        return slot, reading.having(value)

    def _begin(self, slot: SensorSlot) -> None:
        try:
            self._brick.low_speed.write(
                slot - 1, bytes((ADDRESS, UltrasonicRegister.MEASUREMENT)), receive_length=1
            )
        except CommandRefusedError:
            return  # not ready yet, or nothing plugged in: asked again when it is due
        self._fetching, self._fetches = slot, 0

    def _fetch(self, slot: SensorSlot) -> tuple[SensorSlot, Stamped[float]] | None:
        self._fetches += 1
        self._fetching = slot if self._fetches < _FETCHES_MOST else None
        try:
            if not self._brick.low_speed.status(slot - 1).value:
                return None
            reply = self._brick.low_speed.read(slot - 1)
        except CommandRefusedError:
            return None  # the transaction is still going on, or has failed
        self._fetching = None
        return slot, reply.having(float(reply.value[-1]))


def tell(brick: Brick, port: Port, power_pct: int, mode: DriveMode) -> Stamped[None]:
    """Command a motor.

    One that is to coast is let go at once, as a recording says, where the firmware's own coasting fades by 1 % each ms.
    """
    output = OUTPUTS[port]
    if mode == "coast":
        return brick.motors.drive(output, 0, floating=True)
    if mode == "brake":
        return brick.motors.brake(output)
    return brick.motors.drive(output, power_pct, floating=mode == "float")


def reported(state: MotorState) -> tuple[int, DriveMode]:
    """A motor's command as the brick reports it, for motors that another program commands."""
    if not state.mode & MotorMode.ON or state.run_state == RunState.IDLE:
        return 0, "coast"
    if not state.mode & MotorMode.BRAKE:
        return state.power_pct, "float"
    return (state.power_pct, "drive") if state.power_pct else (0, "brake")


def acts_alike(one: tuple[int, DriveMode], other: tuple[int, DriveMode]) -> bool:
    """Whether two commands do alike to a motor: without power, an open bridge coasts."""
    return one == other or all(
        power_pct == 0 and mode in ("coast", "float") for power_pct, mode in (one, other)
    )
