"""The output module: what the host sets, the three motors' control, and the way to the bridges.

Source: LEGO NXT firmware 1.29, c_output.c; the two-tick rhythm is that of the link to the co-processor.
"""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import (
    ModuleId,
    MotorMode,
    OutputFlags,
    OutputMap,
    OutputPortBlock,
    RegulationMode,
    RunState,
    decode_io_map,
    encode_io_map,
    limits,
)
from nxt_twin.mock.firmware.hardware import Hardware
from nxt_twin.mock.firmware.module import Module
from nxt_twin.mock.firmware.motor import (
    DEFAULT_GAINS,
    DEFAULT_MAX_ACCELERATION,
    DEFAULT_MAX_SPEED,
    MotorControl,
)
from nxt_twin.mock.firmware.regulation import Synchronisation, regulate
from nxt_twin.mock.firmware.running import partner, ramp_down, ramp_up, run

REGULATION_TIME_MS: Final = 100

_IDLE, _RAMP_UP, _RUNNING, _RAMP_DOWN, _HOLD = (int(state) for state in RunState)
_SYNC: Final = int(RegulationMode.SYNC)
_COMMAND_FLAGS: Final = OutputFlags.MODE | OutputFlags.SPEED | OutputFlags.TACHO_LIMIT


@final
class OutputPortState:
    """A motor's part of the IO map: settings from the host, and readings that each tick refreshes."""

    __slots__ = (
        "actual_speed",
        "block_tacho_count",
        "flags",
        "max_acceleration",
        "max_speed",
        "mode",
        "motor_rpm",
        "options",
        "overloaded",
        "regulation",
        "regulation_d",
        "regulation_i",
        "regulation_p",
        "rotation_count",
        "run_state",
        "speed",
        "sync_turn",
        "tacho_count",
        "tacho_limit",
    )

    def __init__(self) -> None:
        self.tacho_count = self.block_tacho_count = self.rotation_count = 0
        self.tacho_limit = 0
        self.motor_rpm = 0
        self.flags = 0
        self.mode = 0
        self.speed = self.actual_speed = 0
        self.regulation_p, self.regulation_i, self.regulation_d = DEFAULT_GAINS
        self.run_state = 0
        self.regulation = 0
        self.overloaded = False
        self.sync_turn = 0
        self.options = 0
        self.max_speed = DEFAULT_MAX_SPEED
        self.max_acceleration = DEFAULT_MAX_ACCELERATION

    def export(self) -> OutputPortBlock:
        """The port as it lies in the IO map."""
        return OutputPortBlock(**{name: getattr(self, name) for name in OutputPortState.__slots__})

    def adopt(self, block: OutputPortBlock) -> None:
        """Take over the port from the IO map."""
        for name in OutputPortState.__slots__:
            value = getattr(block, name)
            setattr(self, name, value if isinstance(value, bool) else int(value))


@final
class OutputModule(Module):
    """Three motors."""

    module_id = ModuleId.OUTPUT
    name = "Output.mod"

    def __init__(self, hardware: Hardware) -> None:
        self.ports = tuple(OutputPortState() for _ in range(limits.OUTPUT_PORT_COUNT))
        self.motors = tuple(MotorControl() for _ in self.ports)
        self.pair = Synchronisation()
        self.regulation_time_ms = REGULATION_TIME_MS
        self.regulation_options = 0
        self._hardware = hardware
        self._bridge_turn = False

    def set_state(
        self, port: int, power: int, mode: int, regulation: int, turn: int, run_state: int, limit: int
    ) -> None:
        """What SET_OUT_STATE does: store everything unchecked, to be taken over in the next tick."""
        settings = self.ports[port]
        settings.speed = power
        settings.mode = mode
        settings.options = mode & MotorMode.METHOD
        settings.regulation = regulation
        settings.sync_turn = turn
        settings.run_state = run_state
        settings.tacho_limit = limit
        settings.flags |= _COMMAND_FLAGS

    def reset(self) -> None:
        """Do what the start and the stop of a program do: all motors off, all counters 0."""
        for settings in self.ports:
            settings.mode = settings.speed = settings.sync_turn = 0
            settings.regulation = settings.run_state = 0
            settings.tacho_limit = 0
            settings.flags = int(
                _COMMAND_FLAGS
                | OutputFlags.RESET_COUNT
                | OutputFlags.RESET_BLOCK_COUNT
                | OutputFlags.RESET_ROTATION_COUNT
            )

    def tick(self) -> None:
        """One pass: flags, control, and the readings in the IO map."""
        counts = self._hardware.tacho_counts()
        motors = self.motors
        for index, settings in enumerate(self.ports):
            if settings.flags:
                self._take_over(settings, motors[index], counts[index])
        for index, motor in enumerate(motors):
            self._control(index, motor, counts[index])
        self._bridge_turn = not self._bridge_turn
        if self._bridge_turn:
            for index, motor in enumerate(motors):
                self._hardware.set_motor(index, motor.actual_speed, brake=motor.brake)
        self._publish()

    def _take_over(self, settings: OutputPortState, motor: MotorControl, encoder: int) -> None:
        flags = settings.flags
        if flags & OutputFlags.RESET_ROTATION_COUNT:
            motor.rotation_count = 0
        if flags & OutputFlags.RESET_COUNT:
            self._reset_count(motor)
        if flags & OutputFlags.RESET_BLOCK_COUNT:
            motor.block_count = 0
        if flags & OutputFlags.SPEED and settings.mode & MotorMode.ON:
            motor.command(settings.run_state, settings.speed, settings.sync_turn, encoder)
        if flags & OutputFlags.MODE:
            self._set_mode(settings, motor, encoder)
        if flags & OutputFlags.TACHO_LIMIT:
            motor.limit(settings.tacho_limit)
        if flags & OutputFlags.PID:
            motor.gains = (settings.regulation_p, settings.regulation_i, settings.regulation_d)
            motor.max_speed = settings.max_speed
            motor.max_acceleration = settings.max_acceleration
        settings.flags = flags & OutputFlags.PENDING

    def _set_mode(self, settings: OutputPortState, motor: MotorControl, encoder: int) -> None:
        motor.brake = bool(settings.mode & MotorMode.BRAKE)
        if not settings.mode & MotorMode.ON:
            motor.command(_IDLE, 0, 0, encoder)
            motor.regulation = 0
        elif settings.mode & MotorMode.REGULATED:
            motor.enable_regulation(settings.regulation)
            if settings.regulation & _SYNC and motor.run_state != _RAMP_DOWN:
                self.pair.clear()
        else:
            motor.regulation = 0

    def _reset_count(self, motor: MotorControl) -> None:
        motor.clear_count()
        if motor.regulation & _SYNC:
            other = partner(self.motors, motor)
            if other is not None:
                other.clear_count()
        motor.run_forever = False

    def _control(self, index: int, motor: MotorControl, encoder: int) -> None:
        motor.take_counts(encoder)
        motor.phase_ms = (motor.phase_ms + 1) & 0xFF
        if motor.run_state == _RAMP_UP:
            ramp_up(motor)
        if motor.run_state == _RAMP_DOWN:
            ramp_down(self.motors, motor)
        if motor.run_state == _RUNNING:
            run(self.motors, motor)
        if motor.run_state == _IDLE:
            motor.idle()
        elif motor.run_state == _HOLD:
            motor.hold()
        if motor.phase_ms > self.regulation_time_ms:
            motor.phase_ms = 0
            if motor.regulation:
                regulate(self.motors, index, self.pair, self.regulation_time_ms, self.regulation_options)
            motor.period_count = 0

    def _publish(self) -> None:
        for settings, motor in zip(self.ports, self.motors, strict=True):
            settings.actual_speed = motor.actual_speed
            settings.tacho_count = motor.count
            settings.block_tacho_count = motor.block_count
            settings.rotation_count = motor.rotation_count
            settings.overloaded = motor.overloaded
            if not settings.flags:
                settings.run_state = motor.run_state

    def export(self) -> bytes:
        """The IO map."""
        blocks = tuple(settings.export() for settings in self.ports)
        return encode_io_map(OutputMap(blocks, self.regulation_time_ms, self.regulation_options, bytes(2)))

    def adopt(self, data: bytes) -> None:
        """Take over the IO map; a host that writes flags starts motors this way."""
        given = decode_io_map(OutputMap, data)
        for settings, block in zip(self.ports, given.ports, strict=True):
            settings.adopt(block)
        self.regulation_time_ms = given.regulation_time_ms
        self.regulation_options = given.regulation_options
