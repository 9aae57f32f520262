"""One motor's control: what it was told, how far it is, and what it does in each of its run states.

Source: LEGO NXT firmware 1.29, d_output.c.
"""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import RegulationMode, RunState
from nxt_twin.mock.firmware.integers import s8, s32, sign_of

COUNT_MAX: Final = 10_000_000
"""Beyond this a motor that runs for ever starts counting from 0 again."""

DEFAULT_GAINS: Final = (96, 32, 32)
DEFAULT_MAX_SPEED: Final = 80
DEFAULT_MAX_ACCELERATION: Final = 20


@final
class MotorControl:
    """The state of one motor's control. Speeds are in percent, counts in degrees.

    `set_speed` is what was asked for, `target_speed` where a ramp has got to, `actual_speed` what the bridge
    gets. `limit_count` is the count at which a limited run ends; the next limit is added to it.
    """

    __slots__ = (
        "accumulated_error",
        "actual_speed",
        "block_count",
        "brake",
        "count",
        "gains",
        "limit_count",
        "max_acceleration",
        "max_speed",
        "old_error",
        "overloaded",
        "period_count",
        "phase_ms",
        "position_fraction",
        "position_target",
        "ramp_last",
        "ramp_stall",
        "ramp_start",
        "ramp_step",
        "regulation",
        "rotation_count",
        "run_forever",
        "run_state",
        "seen_count",
        "set_speed",
        "speed_fraction",
        "target_speed",
        "turn",
    )

    def __init__(self) -> None:
        self.set_speed = 0
        self.target_speed = 0
        self.actual_speed = 0
        self.turn = 0
        self.brake = False
        self.run_state = int(RunState.IDLE)
        self.regulation = int(RegulationMode.IDLE)
        self.overloaded = False
        self.run_forever = True
        self.gains = DEFAULT_GAINS
        self.max_speed = DEFAULT_MAX_SPEED
        self.max_acceleration = DEFAULT_MAX_ACCELERATION
        self.phase_ms = 0
        self.accumulated_error = 0
        self.old_error = 0
        self.position_fraction = 0
        self.speed_fraction = 0
        self.position_target = 0
        self.seen_count = 0
        self.period_count = 0
        self.count = 0
        self.block_count = 0
        self.rotation_count = 0
        self.limit_count = 0
        self.ramp_step = 0
        self.ramp_last = 0
        self.ramp_start = 0
        self.ramp_stall = 0

    def take_counts(self, encoder: int) -> None:
        """Add what the encoder has counted since the last time."""
        new = encoder - self.seen_count
        if new:
            self.seen_count = encoder
            self.period_count += new
            self.count += new
            self.block_count += new
            self.rotation_count += new

    def command(self, run_state: int, speed: int, turn: int, encoder: int) -> None:
        """Take a new speed, run state and turn ratio; ignored if they are the current ones."""
        same = self.set_speed == speed and self.run_state == run_state and self.turn == turn
        if same and run_state != RunState.IDLE:
            return
        if self.target_speed == 0:
            self.restart_regulation()
            self.seen_count = encoder
        if run_state == RunState.IDLE:
            self.regulation = RegulationMode.IDLE
        elif run_state == RunState.RAMP_UP:
            run_state = self._command_ramp_up(speed, turn)
        elif run_state == RunState.RUNNING:
            self.set_speed = self.target_speed = speed
            self.turn = turn
            run_state = RunState.RUNNING if speed else RunState.HOLD
        elif run_state == RunState.RAMP_DOWN:
            run_state = self._command_ramp_down(speed, turn)
        self.run_state = run_state
        self.overloaded = False

    def restart_regulation(self) -> None:
        """Clear the regulator's memory and the phase of its period."""
        self.accumulated_error = 0
        self.old_error = 0
        self.position_fraction = 0
        self.phase_ms = 0
        self.period_count = 0

    def _command_ramp_up(self, speed: int, turn: int) -> int:
        direction = sign_of(speed)
        if self.set_speed and direction * self.set_speed >= direction * speed:
            return RunState.RUNNING
        self._start_ramp(speed, turn)
        return RunState.RAMP_UP

    def _command_ramp_down(self, speed: int, turn: int) -> int:
        direction = 1 if self.target_speed >= 0 else -1
        if direction * self.set_speed <= direction * speed:
            return RunState.RUNNING
        self._start_ramp(speed, turn)
        return RunState.RAMP_DOWN

    def _start_ramp(self, speed: int, turn: int) -> None:
        self.set_speed = speed
        self.turn = turn
        self.ramp_step = 0
        self.ramp_start = self.count
        self.ramp_stall = 0

    def enable_regulation(self, mode: int) -> None:
        """Regulate from now on; what a regulator at rest remembers is forgotten."""
        self.regulation = mode
        at_rest = self.set_speed == 0 and self.run_state != RunState.RAMP_DOWN
        if mode & RegulationMode.SPEED and at_rest:
            self.accumulated_error = 0
            self.old_error = 0
            self.position_fraction = 0

    def limit(self, distance: int) -> None:
        """End the run after `distance` counts from where the last one was to end; 0 lets it run for ever.

        In position regulation the distance is the absolute count to go to. The sum wraps at 32 bits, so that a
        distance of more than 2³¹ can lie behind the motor.
        """
        if self.regulation & RegulationMode.POSITION:
            self.run_forever = False
            self.limit_count = s32(distance)
        elif distance == 0:
            self.run_forever = True
        else:
            self.run_forever = False
            self.limit_count = s32(self.limit_count + sign_of(self.set_speed or self.target_speed) * distance)

    def clear_count(self) -> None:
        """Start counting from 0, with no target left."""
        self.count = 0
        self.limit_count = 0
        self.position_target = 0

    def idle(self) -> None:
        """A tick of the idle state: the bridge opens, yet the speed only falls by 1 % a tick."""
        self.brake = False
        if self.actual_speed:
            self.actual_speed -= sign_of(self.actual_speed)
        if self.target_speed:
            self.target_speed -= sign_of(self.target_speed)
        if self.set_speed:
            self.set_speed -= sign_of(self.set_speed)

    def hold(self) -> None:
        """A tick of the hold state, after which the motor runs at speed 0."""
        self.set_speed = self.actual_speed = self.target_speed = 0
        self.position_fraction = 0
        self.phase_ms = 0
        self.period_count = 0
        self.run_state = RunState.RUNNING

    def stop(self) -> None:
        """Go idle without regulation."""
        self.run_state = RunState.IDLE
        self.regulation = RegulationMode.IDLE

    def drive_at(self, speed: int) -> None:
        """Hand a speed to the bridge."""
        self.actual_speed = s8(speed)
