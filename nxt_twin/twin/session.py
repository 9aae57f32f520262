"""A session: brick and twin side by side, at the link's own pace."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import final

from nxt_twin.brick.brick import Brick
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.commands.motors import MotorState
from nxt_twin.brick.errors import GarbageError, LinkError, LinkLostError, LinkTimeoutError
from nxt_twin.recording.columns import (
    BATTERY,
    DRIVE_MODES,
    TIME,
    DriveMode,
    Port,
    mode_column,
    power_column,
    tacho_column,
)
from nxt_twin.recording.lags import KnownLags, RowLags
from nxt_twin.recording.recording import Recording
from nxt_twin.twin.adopt import Adopter
from nxt_twin.twin.brick_twin import BrickTwin
from nxt_twin.twin.driver import Driver
from nxt_twin.twin.history import History, Recorder
from nxt_twin.twin.improver import Improver, RunExperiment
from nxt_twin.twin.monitor import MotorMonitor
from nxt_twin.twin.motor import ReadingEvidence
from nxt_twin.twin.polling import OUTPUTS, Plan, SensorPoll, acts_alike, reported, tell
from nxt_twin.twin.records import Event, EventKind, Innovation, Sink, Tick
from nxt_twin.twin.sensor_twin import SensorTwin
from nxt_twin.twin.settings import BATTERY_AGE_S, Pace
from nxt_twin.twin.timing import Moment, Stalls, Timing

_MISSES_MOST = 3
_ALONE_S = 0.1
_WAITS_S = (0.5, 1.0, 2.0, 4.0, 5.0)
_LOW_AGAIN_V = 0.3
_STALL_TOLD_EVERY_S = 10.0
_FULL_RAD_S = 16.0
_PART_RAD = 0.05
"""A command whose moment is so badly known that, at full power's speed, the angle is in doubt by that much, parts what
is diagnosed."""


@final
@dataclass(frozen=True)
class Parts:
    """The parts of a session.

    Attributes:
        open_brick: opens the link, again after it was lost.
        clock: of all stamps.
        twin: of the brick.
        sink: is told of every poll and event.
        plan: what a poll asks.
        pace: when, between request and reply, the brick acts.
        driver: commands the motors; None leaves that to somebody else, and the brick's word is taken for it.
        recorder: keeps the session.
        adopter: takes over what a diagnosis finds.
        experiment: runs a program once from a moment on, and says when it will be over; None runs none.
        enough: says when it may end before its time.
        lags: by how much readings and commands are off their stamps, of a recording that is played again.
    """

    open_brick: Callable[[], Brick]
    clock: Clock
    twin: BrickTwin
    sink: Sink
    plan: Plan = field(default_factory=Plan)
    pace: Pace = field(default_factory=Pace)
    driver: Driver | None = None
    recorder: Recorder | None = None
    adopter: Adopter | None = None
    experiment: RunExperiment | None = None
    enough: Callable[[], bool] = lambda: False
    lags: KnownLags = field(default_factory=KnownLags)


@final
class Session:
    """Polls, predicts, compares, learns, records and tells. Not for several threads at once.

    In a poll the battery and a sensor come first, if due, then the motors; the row's stamp is that of the last reply.
    Only then are the motors commanded: so a command acts after the counts that stand in its row
    (docs/formats.md#recordings).

    The motors go on as last commanded while the link is lost, as the firmware does; on leaving, they coast.

    Args:
        parts: what it is put together from.

    Attributes:
        monitors: one for each motor.
        polls: how many there were.
        lasted_s: how long the last run was, from when the brick was reached.
        unseen_s: of which the link was lost.
        stalls: how often a round trip took far longer than usual.
        row_lags: by how much what is in a row is off its stamp.
    """

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._clock, self._twin, self._sink = parts.clock, parts.twin, parts.sink
        self._began_s = parts.clock.now_s()
        watch = parts.twin.options.watch
        self.monitors = {port: MotorMonitor(port, watch) for port in parts.twin.ports}
        self._history = {port: History(port) for port in parts.twin.ports}
        self._sensors = {slot: SensorTwin(slot, kind) for slot, kind in parts.plan.sensors.items()}
        self._counts: dict[Port, int] = {}
        self._presumed: set[Port] = set()
        self._doubt_s = 0.0
        self._battery_due_s = 0.0
        self._battery_low = False
        self._misses = 0
        self._timing = Timing(parts.pace)
        self._improver = Improver(
            parts.adopter, parts.twin, self.monitors, self._history, parts.sink, parts.experiment
        )
        self._stall_told_s = -_STALL_TOLD_EVERY_S
        self.stalls = Stalls()
        self.row_lags = RowLags()
        self.polls = 0
        self.lasted_s = 0.0
        self.unseen_s = 0.0

    @property
    def now_s(self) -> float:
        """Time since the session began, which is when the brick was reached, s."""
        return self._clock.now_s() - self._began_s

    def seen(self, port: Port) -> Recording:
        """The readings of a motor so far: commands and counts at their moments, as a diagnosis takes them."""
        return self._history[port].recording(0.0, self._twin.supply_at)

    def run(self, seconds: float | None) -> None:
        """Go on for so long, or until interrupted.

        Raises:
            LinkError: the first link could not be opened, or a lost one cannot ever be again.
            NxtTwinError: the recorder failed.
        """
        brick = self._parts.open_brick()
        self._began_s = self._clock.now_s()
        try:
            watched = [port.upper() for port in self._twin.ports]
            self._tell("started", f"the twin watches motor{'s' * (len(watched) > 1)} {', '.join(watched)}")
            while not self._over(seconds):
                brick = self._through(brick, seconds)
            self._tell("stopped", "; ".join(filter(None, (self._length(), self.stalls.words()))))
        finally:
            self.lasted_s = self.now_s
            brick.close()

    def _length(self) -> str:
        return f"the session ends after {self.now_s:.1f} s and {self.polls} polls"

    def _over(self, seconds: float | None) -> bool:
        return (seconds is not None and self.now_s >= seconds) or self._parts.enough()

    def _through(self, brick: Brick, seconds: float | None) -> Brick:
        """Poll until the link is lost or time is over; the brick to go on with."""
        try:
            sensors = SensorPoll(brick, self._parts.plan)
            sensors.set_up()
            while not self._over(seconds):
                began_s = self.now_s
                self._poll_or_miss(brick, sensors)
                left_s = began_s + self._parts.plan.period_s - self.now_s
                if left_s > 0.0:
                    self._clock.sleep(left_s)
        except LinkError as error:
            self._tell("link_lost", f"the link is lost ({error}); the model runs on without readings")
            brick.close()
            lost_s = self.now_s
            try:
                return self._reopen(seconds) or brick
            finally:
                self.unseen_s += self.now_s - lost_s
        return brick

    def _poll_or_miss(self, brick: Brick, sensors: SensorPoll) -> None:
        try:
            self._poll(brick, sensors)
            self._misses = 0
        except (LinkTimeoutError, GarbageError) as error:
            self._misses += 1
            if self._misses >= _MISSES_MOST:
                raise LinkLostError(f"{self._misses} polls in a row failed: {error.what}") from error

    def _poll(self, brick: Brick, sensors: SensorPoll) -> None:
        sent_s = self.now_s
        row: dict[str, float] = {}
        battery_v = self._battery(brick, row)
        of_sensors = self._sensor(sensors, row)
        innovations = [self._motor(brick, port, row) for port in self._twin.ports]
        received_s = row[TIME]
        self.row_lags.row(received_s)
        try:
            self._drive(brick, received_s)
        finally:  # what was read is kept, whether or not the brick answers a command
            self._put_down(row)
        states = tuple(self._twin.state(port) for port in self._twin.ports)
        read = (*innovations, *of_sensors)
        self._sink.tick(Tick(self.polls, sent_s, received_s, states, read, battery_v))
        self.polls += 1
        self._improver.step(self.now_s, self._doubt_s)

    def _put_down(self, row: dict[str, float]) -> None:
        for port in self._twin.ports:
            power_pct, mode = self._twin.commanded(port)
            row[power_column(port)] = float(power_pct)
            row[mode_column(port)] = float(DRIVE_MODES.index(mode))
        if self._parts.recorder is not None:
            self._parts.recorder.row(row)

    def _drive(self, brick: Brick, now_s: float) -> None:
        if self._parts.driver is None:
            return
        for port, (power_pct, mode) in self._parts.driver.at(now_s, self._counts).items():
            if self._twin.commanded(port) == (power_pct, mode) and self.polls > 0:
                continue
            taken = self._told(brick, port, power_pct, mode)
            after_s, doubt_s = self._parts.lags.acted_after_s(port)
            taken = taken._replace(at_s=taken.at_s + after_s, std_s=math.hypot(taken.std_s, doubt_s))
            self._commanded(port, taken, power_pct, mode)
            self.row_lags.acted(port, taken.at_s + self._parts.pace.command_lag_s - now_s, taken.std_s)

    def _told(self, brick: Brick, port: Port, power_pct: int, mode: DriveMode) -> Moment:
        """Command a motor; when the brick took it up.

        A brick that does not answer has taken it up all the same, as a rule: so it is presumed until the next reading.
        """
        sent_s = self.now_s
        try:
            reply = tell(brick, port, power_pct, mode)
        except (LinkTimeoutError, GarbageError):
            self._presumed.add(port)
            self._commanded(port, self._timing.presumed(sent_s), power_pct, mode)
            raise
        return self._taken(reply.sent_s, reply.received_s)

    def _settle(self, port: Port, at_s: float, state: MotorState) -> None:
        """After a command without an answer: take the brick's word for what is in force, and begin where it is."""
        self._presumed.discard(port)
        self._twin.move(at_s)
        if not acts_alike(reported(state), self._twin.commanded(port)):
            self._commanded(port, Moment(at_s, 0.0, late=True, stall_s=0.0), *reported(state))
        self._twin.place(port, state.tacho_deg, self._twin.speed_rad_s(port))

    def _commanded(
        self, port: Port, taken: Moment, power_pct: int, mode: DriveMode, *, fading: bool = False
    ) -> None:
        """The brick took a command up; it reaches the motor a little later."""
        at_s = taken.at_s + self._parts.pace.command_lag_s
        before, _ = self._twin.commanded(port)
        holds = self._twin.command(port, power_pct, mode, at_s, taken.std_s, fading=fading)
        self._history[port].command(at_s, holds)
        doubt_rad = taken.std_s * abs(power_pct - before) / 100.0 * _FULL_RAD_S
        if taken.late and doubt_rad > _PART_RAD:
            self._history[port].part(at_s)

    def _motor(self, brick: Brick, port: Port, row: dict[str, float]) -> Innovation:
        reply = brick.motors.read(OUTPUTS[port])
        taken = self._taken(reply.sent_s, reply.received_s)
        before_s, doubt_s = self._parts.lags.read_before_s(port)
        at_s, count = taken.at_s - self._parts.pace.count_age_s - before_s, reply.value.tacho_deg
        std_s = math.hypot(taken.std_s, doubt_s)
        self.row_lags.taken(port, at_s, std_s)
        row[TIME] = reply.received_s - self._began_s
        if self._parts.driver is None or port not in self._parts.driver.ports:
            power_pct, mode = reported(reply.value)
            if (power_pct, mode) != self._twin.commanded(port):
                then = taken._replace(at_s=min(at_s, self._twin.now_s))
                self._commanded(port, then, power_pct, mode, fading=True)
        if port in self._presumed:
            self._settle(port, at_s, reply.value)
        power_pct, _ = self._twin.commanded(port)
        evidence = self._twin.read_tacho(port, at_s, count, std_s)
        self._counts[port] = count
        if not taken.late:
            self._history[port].count(at_s, count)
            self._doubt_s = std_s
        self._watch(port, at_s, evidence, power_pct)
        row[tacho_column(port)] = float(count)
        return evidence.innovation

    def _watch(self, port: Port, time_s: float, evidence: ReadingEvidence, power_pct: int) -> None:
        monitor = self.monitors[port]
        effects = self._twin.motor(port).probabilities
        for event in monitor.take(time_s, evidence, power_pct, effects):
            if event.kind == "divergence":
                self._twin.forget_evidence(port)
            self._sink.event(event)
        if monitor.trouble:
            self._twin.begin_anew(port)

    def _sensor(self, sensors: SensorPoll, row: dict[str, float]) -> list[Innovation]:
        found = sensors.next(self.now_s)
        if found is None:
            return []
        slot, reply = found
        taken = self._taken(reply.sent_s, reply.received_s)
        row[self._sensors[slot].column] = reply.value
        innovation = self._sensors[slot].read(taken.at_s, reply.value)
        return [] if innovation is None else [innovation]

    def _battery(self, brick: Brick, row: dict[str, float]) -> float | None:
        if self.now_s < self._battery_due_s:
            return None
        self._battery_due_s = self.now_s + self._parts.plan.battery_every_s
        reply = brick.device.battery_v()
        voltage_v, taken = reply.value, self._taken(reply.sent_s, reply.received_s)
        self._twin.read_battery(voltage_v, taken.at_s, BATTERY_AGE_S + taken.std_s)
        row[BATTERY] = voltage_v
        lowest_v = self._twin.options.watch.low_battery_v
        if voltage_v < lowest_v and not self._battery_low:
            self._battery_low = True
            self._tell(
                "low_battery",
                f"the battery is down to {voltage_v:.2f} V; change the cells before you rely on the twin",
            )
        elif voltage_v > lowest_v + _LOW_AGAIN_V:
            self._battery_low = False
        return voltage_v

    def _taken(self, sent_s: float, received_s: float) -> Moment:
        """When, in the session's time, the brick took up what it was asked."""
        moment = self._timing.moment(sent_s - self._began_s, received_s - self._began_s)
        if moment.stall_s:
            self._stalled(moment)
        return moment

    def _stalled(self, moment: Moment) -> None:
        """That the host stood still is nothing that a motor's model lacks: said, and left out of diagnoses."""
        self.stalls.add(moment.stall_s)
        if moment.at_s - self._stall_told_s < _STALL_TOLD_EVERY_S:
            return
        self._stall_told_s = moment.at_s
        self._tell(
            "stalled",
            f"the host or the link stood still: a reply took {1e3 * moment.stall_s:.0f} ms longer than usual; "
            "diagnoses leave such readings out",
        )

    def _reopen(self, seconds: float | None) -> Brick | None:
        """Try to reach the brick again, while the model goes on; None if time is over first."""
        self._misses = 0
        tries = 0
        while not self._over(seconds):
            wait_s = _WAITS_S[min(tries, len(_WAITS_S) - 1)]
            tries += 1
            self._alone(wait_s, seconds)
            try:
                brick = self._parts.open_brick()
                self._come_back(brick)
            except LinkError:
                continue
            return brick
        return None

    def _come_back(self, brick: Brick) -> None:
        """Begin anew where the motors are: the brick may have been switched off, and counts from 0 then."""
        for port in self._twin.ports:
            reply = brick.motors.read(OUTPUTS[port])
            taken = self._taken(reply.sent_s, reply.received_s)
            self._twin.move(taken.at_s)
            power_pct, mode = reported(reply.value)
            self._commanded(port, taken, power_pct, mode)
            self._twin.place(port, reply.value.tacho_deg)
            self._counts[port] = reply.value.tacho_deg
            self._presumed.discard(port)
            self.monitors[port].forget(taken.at_s)
            self._improver.begin_anew(port)
        self._tell("link_back", "the link is back; the model starts at the counts just read")

    def _alone(self, duration_s: float, seconds: float | None) -> None:
        end_s = self.now_s + duration_s
        while self.now_s < end_s and not self._over(seconds):
            self._clock.sleep(min(_ALONE_S, end_s - self.now_s))
            now_s = self.now_s
            self._twin.move(now_s)
            states = tuple(self._twin.state(port) for port in self._twin.ports)
            self._sink.tick(Tick(self.polls, now_s, now_s, states, (), link_up=False))

    def _tell(self, kind: EventKind, words: str) -> None:
        self._sink.event(Event(self.now_s, kind, words))
