"""Which command an opcode belongs to."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any, Final

from firmware_protocol.command import Command
from firmware_protocol.commands import (
    device,
    files,
    lowspeed,
    messages,
    modules,
    motors,
    programs,
    sensors,
    settings,
    sound,
)
from firmware_protocol.enums import TelegramType
from firmware_protocol.errors import OpcodeError

_COMMANDS: Final[tuple[type[Command[Any]], ...]] = (
    programs.StartProgram,
    programs.StopProgram,
    sound.PlaySoundFile,
    sound.PlayTone,
    motors.SetOutputState,
    sensors.SetInputMode,
    motors.GetOutputState,
    sensors.GetInputValues,
    sensors.ResetInputScaledValue,
    messages.MessageWrite,
    motors.ResetMotorPosition,
    settings.GetBatteryLevel,
    sound.StopSound,
    settings.KeepAlive,
    lowspeed.LowSpeedGetStatus,
    lowspeed.LowSpeedWrite,
    lowspeed.LowSpeedRead,
    programs.GetCurrentProgram,
    messages.MessageRead,
    programs.DatalogRead,
    programs.DatalogSetTimes,
    settings.BluetoothContactCount,
    settings.BluetoothContactName,
    settings.BluetoothConnectionCount,
    settings.BluetoothConnectionName,
    settings.SetProperty,
    settings.GetProperty,
    motors.ResetTachoCount,
    files.OpenRead,
    files.OpenWrite,
    files.ReadFile,
    files.WriteFile,
    files.CloseFile,
    files.DeleteFile,
    files.FindFirst,
    files.FindNext,
    device.GetVersions,
    files.OpenWriteLinear,
    files.OpenWriteData,
    files.OpenAppendData,
    files.CropDataFile,
    modules.FindFirstModule,
    modules.FindNextModule,
    modules.CloseModule,
    modules.IoMapRead,
    modules.IoMapWrite,
    device.Boot,
    device.SetBrickName,
    device.BluetoothGetAddress,
    device.GetDeviceInfo,
    files.DeleteUserFlash,
    device.PollLength,
    device.Poll,
    device.BluetoothFactoryReset,
)
_BY_OPCODE: Final = MappingProxyType({(command.KIND, command.OPCODE): command for command in _COMMANDS})


def all_commands() -> tuple[type[Command[Any]], ...]:
    """Every command, direct ones first, by opcode."""
    return _COMMANDS


def find_command(kind: int, opcode: int) -> type[Command[Any]]:
    """The command of an opcode.

    Args:
        kind: `TelegramType.DIRECT` or `TelegramType.SYSTEM`; an opcode counts only within its kind.
        opcode: the telegram's second byte.

    Raises:
        OpcodeError: the firmware implements no such command.
    """
    try:
        return _BY_OPCODE[TelegramType(kind), opcode]
    except (KeyError, ValueError):
        raise OpcodeError(f"no command has opcode 0x{opcode:02X} in telegrams of type 0x{kind:02X}") from None
