"""A brick as a function, bytes in, bytes out: just enough of one for the checks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import firmware_protocol as fp
from firmware_protocol import Status
from firmware_protocol.ultrasonic import ADDRESS, UltrasonicRegister

DISTANCE_CM = 42
_UNPLUGGED = (True, False, 0, 0, 1023, 1023, 1023, 0)
ADDRESS_BYTES = bytes.fromhex("00165301020300")


class FakeBrick:
    """State and one method a group of commands; `answer` is the function."""

    def __init__(self) -> None:
        self.motors = [fp.GetOutputState.Reply(port, 0, 0, 0, 0, 0, 0, 0, 0, 0) for port in range(3)]
        self.inputs = [fp.GetInputValues.Reply(port, *_UNPLUGGED) for port in range(4)]
        self.received = [b""] * 4
        self.files: dict[str, bytearray] = {}
        self.handles: dict[int, tuple[str, int]] = {}
        self.searches: dict[int, list[str]] = {}
        self.name = "NXT"
        self.volume = 3

    def answer(self, telegram: bytes) -> bytes | None:
        """The reply to a telegram; None where the brick keeps silent."""
        try:
            request, wants_reply = fp.decode_request(telegram)
        except fp.OpcodeError:
            return fp.encode_status(telegram[1], Status.UNKNOWN_OPCODE) if telegram[0] < 2 else None
        except fp.TelegramError:
            return None
        handler: Callable[[Any], Any] | None = getattr(self, f"on_{type(request).__name__}", None)
        outcome = fp.NoData() if handler is None and request.Reply is fp.NoData else Status.UNKNOWN_OPCODE
        if handler is not None:
            outcome = handler(request)
        if not wants_reply:
            return None
        if isinstance(outcome, Status):
            return fp.encode_reply(request, status=outcome)
        return fp.encode_reply(request, outcome)

    def on_SetOutputState(self, asked: fp.SetOutputState) -> fp.NoData | Status:
        ports = range(3) if asked.port == fp.OutputPort.ALL else [asked.port]
        if ports[0] > 2:
            return Status.VALUE_OUT_OF_RANGE
        for port in ports:
            self.motors[port] = replace(
                self.motors[port],
                power=asked.power,
                mode=asked.mode,
                regulation=asked.regulation,
                turn_ratio=asked.turn_ratio,
                run_state=asked.run_state if asked.mode & fp.MotorMode.ON else fp.RunState.IDLE,
                tacho_limit=asked.tacho_limit,
            )
        return fp.NoData()

    def on_GetOutputState(self, asked: fp.GetOutputState) -> fp.GetOutputState.Reply | Status:
        return self.motors[asked.port] if asked.port < 3 else Status.VALUE_OUT_OF_RANGE

    def on_ResetMotorPosition(self, asked: fp.ResetMotorPosition) -> fp.NoData | Status:
        return fp.NoData() if asked.port < 3 else Status.VALUE_OUT_OF_RANGE

    def on_SetInputMode(self, asked: fp.SetInputMode) -> fp.NoData | Status:
        if asked.port > 3:
            return Status.VALUE_OUT_OF_RANGE
        self.inputs[asked.port] = replace(
            self.inputs[asked.port], sensor_type=asked.sensor_type, sensor_mode=asked.sensor_mode
        )
        return fp.NoData()

    def on_GetInputValues(self, asked: fp.GetInputValues) -> fp.GetInputValues.Reply | Status:
        return self.inputs[asked.port] if asked.port < 4 else Status.VALUE_OUT_OF_RANGE

    def _is_digital(self, port: int) -> bool:
        return self.inputs[port].sensor_type in (fp.SensorType.LOW_SPEED, fp.SensorType.LOW_SPEED_9V)

    def on_LowSpeedWrite(self, asked: fp.LowSpeedWrite) -> fp.NoData | Status:
        if not self._is_digital(asked.port):
            return Status.CHANNEL_NOT_READY
        if asked.data == bytes((ADDRESS, UltrasonicRegister.MEASUREMENT)):
            self.received[asked.port] += bytes((DISTANCE_CM,)) + b"\xff" * (asked.receive_length - 1)
        return fp.NoData()

    def on_LowSpeedGetStatus(self, asked: fp.LowSpeedGetStatus) -> fp.LowSpeedGetStatus.Reply | Status:
        if not self._is_digital(asked.port):
            return Status.CHANNEL_NOT_READY
        return fp.LowSpeedGetStatus.Reply(len(self.received[asked.port]))

    def on_LowSpeedRead(self, asked: fp.LowSpeedRead) -> fp.LowSpeedRead.Reply:
        taken, self.received[asked.port] = self.received[asked.port], b""
        return fp.LowSpeedRead.Reply.of(taken)

    def on_OpenWriteData(self, asked: fp.OpenWriteData) -> fp.FileHandle | Status:
        return self.on_OpenWrite(asked)

    def on_OpenWrite(self, asked: fp.OpenWrite | fp.OpenWriteData) -> fp.FileHandle | Status:
        if asked.name in self.files:
            return Status.FILE_EXISTS
        self.files[asked.name] = bytearray()
        return fp.FileHandle(self._handle((asked.name, 0)))

    def on_OpenRead(self, asked: fp.OpenRead) -> fp.FileOpened | Status:
        if asked.name not in self.files:
            return Status.FILE_NOT_FOUND
        return fp.FileOpened(self._handle((asked.name, 0)), len(self.files[asked.name]))

    def on_ReadFile(self, asked: fp.ReadFile) -> fp.ReadFile.Reply | Status:
        if asked.handle not in self.handles:
            return Status.ILLEGAL_HANDLE
        name, at = self.handles[asked.handle]
        self.handles[asked.handle] = name, at + asked.length
        data = bytes(self.files[name][at : at + asked.length])
        return fp.ReadFile.Reply(asked.handle, asked.length, data)

    def on_WriteFile(self, asked: fp.WriteFile) -> fp.WriteFile.Reply | Status:
        if asked.handle not in self.handles:
            return Status.ILLEGAL_HANDLE
        self.files[self.handles[asked.handle][0]] += asked.data
        return fp.WriteFile.Reply(asked.handle, len(asked.data))

    def on_CloseFile(self, asked: fp.CloseFile) -> fp.FileHandle | Status:
        self.searches.pop(asked.handle, None)
        return fp.FileHandle(asked.handle) if self.handles.pop(asked.handle, None) else _CLOSED

    def on_DeleteFile(self, asked: fp.DeleteFile) -> fp.DeleteFile.Reply | Status:
        if self.files.pop(asked.name, None) is None:
            return Status.FILE_NOT_FOUND
        return fp.DeleteFile.Reply(asked.name)

    def on_FindFirst(self, asked: fp.FindFirst) -> fp.FileFound | Status:
        matching = [name for name in reversed(self.files) if fp.pattern_matches(asked.pattern, name)]
        if not matching:
            return Status.FILE_NOT_FOUND
        handle = self._handle(("", 0))
        self.searches[handle] = matching
        return self.on_FindNext(fp.FindNext(handle))

    def on_FindNext(self, asked: fp.FindNext) -> fp.FileFound | Status:
        if not self.searches.get(asked.handle):
            return Status.FILE_NOT_FOUND
        name = self.searches[asked.handle].pop(0)
        return fp.FileFound(asked.handle, name, len(self.files[name]))

    def _handle(self, what: tuple[str, int]) -> int:
        handle = next(free for free in range(16) if free not in self.handles)
        self.handles[handle] = what
        return handle

    def on_GetBatteryLevel(self, asked: fp.GetBatteryLevel) -> fp.GetBatteryLevel.Reply:
        del asked
        return fp.GetBatteryLevel.Reply(7950)

    def on_KeepAlive(self, asked: fp.KeepAlive) -> fp.KeepAlive.Reply:
        del asked
        return fp.KeepAlive.Reply(600_000)

    def on_GetVersions(self, asked: fp.GetVersions) -> fp.GetVersions.Reply:
        del asked
        return fp.GetVersions.Reply(124, 1, 29, 1)

    def on_GetDeviceInfo(self, asked: fp.GetDeviceInfo) -> fp.GetDeviceInfo.Reply:
        del asked
        return fp.GetDeviceInfo.Reply(self.name, ADDRESS_BYTES, bytes(4), 60_000)

    def on_SetBrickName(self, asked: fp.SetBrickName) -> fp.NoData:
        self.name = asked.name
        return fp.NoData()

    def on_GetProperty(self, asked: fp.GetProperty) -> fp.GetProperty.Reply:
        value = self.volume if asked.property_id == fp.PropertyId.VOLUME else 600_000
        return fp.GetProperty.Reply.of(asked.property_id, value)

    def on_SetProperty(self, asked: fp.SetProperty) -> fp.NoData:
        self.volume = asked.value
        return fp.NoData()

    def on_GetCurrentProgram(self, asked: fp.GetCurrentProgram) -> Status:
        del asked
        return Status.NO_ACTIVE_PROGRAM

    def on_MessageRead(self, asked: fp.MessageRead) -> Status:
        del asked
        return Status.NO_ACTIVE_PROGRAM

    def on_IoMapRead(self, asked: fp.IoMapRead) -> fp.IoMapRead.Reply:
        data = b"MindstormsNXT".ljust(asked.offset + asked.length, b"\0")[asked.offset :][: asked.length]
        return fp.IoMapRead.Reply(asked.module_id, asked.length, data)


_CLOSED = Status.HANDLE_ALREADY_CLOSED
