"""Telegrams spelled out byte by byte, from LEGO's own description of the protocol."""

from __future__ import annotations

from typing import Any

import pytest

from firmware_protocol import (
    BluetoothConnectionCount,
    BluetoothConnectionName,
    BluetoothContactCount,
    BluetoothContactName,
    BluetoothFactoryReset,
    BluetoothGetAddress,
    Boot,
    CloseFile,
    CloseModule,
    Command,
    CropDataFile,
    DatalogRead,
    DatalogSetTimes,
    DeleteFile,
    DeleteUserFlash,
    FileFound,
    FileHandle,
    FileOpened,
    FindFirst,
    FindFirstModule,
    FindNext,
    FindNextModule,
    GetBatteryLevel,
    GetCurrentProgram,
    GetDeviceInfo,
    GetInputValues,
    GetOutputState,
    GetProperty,
    GetVersions,
    InputPort,
    IoMapRead,
    IoMapWrite,
    KeepAlive,
    LowSpeedGetStatus,
    LowSpeedRead,
    LowSpeedWrite,
    MessageRead,
    MessageWrite,
    ModuleFound,
    ModuleId,
    MotorMode,
    NoData,
    OpenAppendData,
    OpenRead,
    OpenWrite,
    OpenWriteData,
    OpenWriteLinear,
    OutputPort,
    PlaySoundFile,
    PlayTone,
    Poll,
    PollBuffer,
    PollLength,
    PropertyId,
    ReadFile,
    RegulationMode,
    ReplyData,
    ResetInputScaledValue,
    ResetMotorPosition,
    ResetTachoCount,
    RunState,
    SensorMode,
    SensorType,
    SetBrickName,
    SetInputMode,
    SetOutputState,
    SetProperty,
    StartProgram,
    StopProgram,
    StopSound,
    WriteFile,
    all_commands,
    decode_reply,
    decode_request,
    encode_reply,
    encode_request,
)

DEMO = "64 65 6D 6F 2E 72 78 65" + " 00" * 12  # demo.rxe in 20 bytes

REQUESTS: list[tuple[Command[Any], str]] = [
    (StartProgram("demo.rxe"), f"00 00 {DEMO}"),
    (StopProgram(), "00 01"),
    (PlaySoundFile(loop=True, name="demo.rxe"), f"00 02 01 {DEMO}"),
    (PlayTone(frequency_hz=440, duration_ms=1000), "00 03 B8 01 E8 03"),
    (
        SetOutputState(
            port=OutputPort.ALL,
            power=-100,
            mode=MotorMode.ON | MotorMode.BRAKE | MotorMode.REGULATED,
            regulation=RegulationMode.SYNC,
            turn_ratio=-1,
            run_state=RunState.RUNNING,
            tacho_limit=360,
        ),
        "00 04 FF 9C 07 02 FF 20 68 01 00 00",
    ),
    (SetInputMode(InputPort.S4, SensorType.LOW_SPEED_9V, SensorMode.RAW), "00 05 03 0B 00"),
    (GetOutputState(OutputPort.B), "00 06 01"),
    (GetInputValues(InputPort.S3), "00 07 02"),
    (ResetInputScaledValue(InputPort.S1), "00 08 00"),
    (MessageWrite.of(mailbox=0, message=b"hi"), "00 09 00 03 68 69 00"),
    (ResetMotorPosition(OutputPort.C, relative=True), "00 0A 02 01"),
    (GetBatteryLevel(), "00 0B"),
    (StopSound(), "00 0C"),
    (KeepAlive(), "00 0D"),
    (LowSpeedGetStatus(InputPort.S4), "00 0E 03"),
    (LowSpeedWrite.of(InputPort.S4, b"\x02\x42", receive_length=1), "00 0F 03 02 01 02 42"),
    (LowSpeedRead(InputPort.S4), "00 10 03"),
    (GetCurrentProgram(), "00 11"),
    (MessageRead(remote_mailbox=10, local_mailbox=0, remove=True), "00 13 0A 00 01"),
    (DatalogRead(remove=False), "00 19 00"),
    (DatalogSetTimes(sync_time=-2), "00 1A FE FF FF FF"),
    (BluetoothContactCount(), "00 1B"),
    (BluetoothContactName(index=29), "00 1C 1D"),
    (BluetoothConnectionCount(), "00 1D"),
    (BluetoothConnectionName(index=3), "00 1E 03"),
    (SetProperty(PropertyId.VOLUME, 4), "00 1F 01 04"),
    (SetProperty(PropertyId.SLEEP_TIMEOUT, 600_000), "00 1F 02 C0 27 09 00"),
    (GetProperty(PropertyId.SLEEP_TIMEOUT), "00 20 02"),
    (ResetTachoCount(OutputPort.A), "00 21 00"),
    (OpenRead("demo.rxe"), f"01 80 {DEMO}"),
    (OpenWrite("demo.rxe", size=0x0123), f"01 81 {DEMO} 23 01 00 00"),
    (ReadFile(handle=0, length=258), "01 82 00 02 01"),
    (WriteFile(handle=1, data=b"\xaa\xbb"), "01 83 01 AA BB"),
    (CloseFile(handle=1), "01 84 01"),
    (DeleteFile("demo.rxe"), f"01 85 {DEMO}"),
    (FindFirst("*.*"), "01 86 2A 2E 2A" + " 00" * 17),
    (FindNext(handle=2), "01 87 02"),
    (GetVersions(), "01 88"),
    (OpenWriteLinear("demo.rxe", size=1), f"01 89 {DEMO} 01 00 00 00"),
    (OpenWriteData("demo.rxe", size=1), f"01 8B {DEMO} 01 00 00 00"),
    (OpenAppendData("demo.rxe"), f"01 8C {DEMO}"),
    (CropDataFile(handle=3), "01 8D 03"),
    (FindFirstModule("*.*"), "01 90 2A 2E 2A" + " 00" * 17),
    (FindNextModule(handle=0), "01 91 00"),
    (CloseModule(handle=0), "01 92 00"),
    (IoMapRead(ModuleId.OUTPUT, offset=32, length=4), "01 94 01 00 02 00 20 00 04 00"),
    (IoMapWrite.of(ModuleId.OUTPUT, offset=19, data=b"\x01"), "01 95 01 00 02 00 13 00 01 00 01"),
    (Boot(), "01 97 4C 65 74 27 73 20 64 61 6E 63 65 3A 20 53 41 4D 42 41 00"),
    (SetBrickName("NXT"), "01 98 4E 58 54" + " 00" * 13),
    (BluetoothGetAddress(), "01 9A"),
    (GetDeviceInfo(), "01 9B"),
    (DeleteUserFlash(), "01 A0"),
    (PollLength(PollBuffer.HIGH_SPEED), "01 A1 01"),
    (Poll(PollBuffer.USB, length=57), "01 A2 00 39"),
    (BluetoothFactoryReset(), "01 A4"),
]

OUTPUT_STATE = GetOutputState.Reply(
    port=OutputPort.B,
    power=-75,
    mode=MotorMode.ON | MotorMode.BRAKE,
    regulation=RegulationMode.SPEED,
    turn_ratio=-100,
    run_state=RunState.RAMP_UP,
    tacho_limit=720,
    tacho_count=-1,
    block_tacho_count=2,
    rotation_count=-32769,
)
INPUT_VALUES = GetInputValues.Reply(
    port=InputPort.S1,
    valid=True,
    calibrated=False,
    sensor_type=SensorType.SWITCH,
    sensor_mode=SensorMode.BOOLEAN,
    raw=183,
    normalised=183,
    scaled=1,
    calibrated_value=183,
)
ADDRESS = b"\x00\x16\x53\x01\x02\x03\x00"

REPLIES: list[tuple[type[Command[Any]], ReplyData, str]] = [
    (
        GetOutputState,
        OUTPUT_STATE,
        "02 06 00 01 B5 03 01 9C 10 D0 02 00 00 FF FF FF FF 02 00 00 00 FF 7F FF FF",
    ),
    (GetInputValues, INPUT_VALUES, "02 07 00 00 01 00 01 20 B7 00 B7 00 01 00 B7 00"),
    (GetBatteryLevel, GetBatteryLevel.Reply(voltage_mv=7902), "02 0B 00 DE 1E"),
    (KeepAlive, KeepAlive.Reply(sleep_timeout_ms=600_000), "02 0D 00 C0 27 09 00"),
    (LowSpeedGetStatus, LowSpeedGetStatus.Reply(bytes_ready=1), "02 0E 00 01"),
    (LowSpeedRead, LowSpeedRead.Reply.of(b"\x2a"), "02 10 00 01 2A" + " 00" * 15),
    (GetCurrentProgram, GetCurrentProgram.Reply("demo.rxe"), f"02 11 00 {DEMO}"),
    (MessageRead, MessageRead.Reply.of(mailbox=0, message=b"hi"), "02 13 00 00 03 68 69" + " 00" * 57),
    (DatalogRead, DatalogRead.Reply(1, b"\x07".ljust(60, b"\0")), "02 19 00 01 07" + " 00" * 59),
    (BluetoothContactCount, BluetoothContactCount.Reply(30), "02 1B 00 1E"),
    (BluetoothContactName, BluetoothContactName.Reply(1, "NXT"), "02 1C 00 01 4E 58 54" + " 00" * 14),
    (BluetoothConnectionCount, BluetoothConnectionCount.Reply(4), "02 1D 00 04"),
    (BluetoothConnectionName, BluetoothConnectionName.Reply(0, ""), "02 1E 00 00" + " 00" * 17),
    (GetProperty, GetProperty.Reply.of(PropertyId.VOLUME, 3), "02 20 00 03"),
    (GetProperty, GetProperty.Reply.of(PropertyId.SLEEP_TIMEOUT, 60_000), "02 20 00 60 EA 00 00"),
    (OpenRead, FileOpened(handle=0, size=0x010203), "02 80 00 00 03 02 01 00"),
    (OpenWrite, FileHandle(handle=1), "02 81 00 01"),
    (ReadFile, ReadFile.Reply(handle=0, length=2, data=b"\xaa\xbb"), "02 82 00 00 02 00 AA BB"),
    (WriteFile, WriteFile.Reply(handle=1, written=2), "02 83 00 01 02 00"),
    (CloseFile, FileHandle(handle=1), "02 84 00 01"),
    (DeleteFile, DeleteFile.Reply("demo.rxe"), f"02 85 00 {DEMO}"),
    (FindFirst, FileFound(handle=0, name="demo.rxe", size=256), f"02 86 00 00 {DEMO} 00 01 00 00"),
    (FindNext, FileFound(handle=0, name="demo.rxe", size=256), f"02 87 00 00 {DEMO} 00 01 00 00"),
    (GetVersions, GetVersions.Reply(124, 1, 29, 1), "02 88 00 7C 01 1D 01"),
    (OpenWriteLinear, FileHandle(handle=1), "02 89 00 01"),
    (OpenWriteData, FileHandle(handle=1), "02 8B 00 01"),
    (OpenAppendData, FileOpened(handle=2, size=7), "02 8C 00 02 07 00 00 00"),
    (CropDataFile, FileHandle(handle=3), "02 8D 00 03"),
    (
        FindFirstModule,
        ModuleFound(handle=0, name="Output.mod", module_id=ModuleId.OUTPUT, size=0, io_map_size=100),
        "02 90 00 00 4F 75 74 70 75 74 2E 6D 6F 64" + " 00" * 10 + " 01 00 02 00 00 00 00 00 64 00",
    ),
    (CloseModule, CloseModule.Reply(handle=0), "02 92 00 00"),
    (
        IoMapRead,
        IoMapRead.Reply(ModuleId.LOADER, length=4, data=b"\x00\x10\x01\x00"),
        "02 94 00 01 00 09 00 04 00 00 10 01 00",
    ),
    (IoMapWrite, IoMapWrite.Reply(ModuleId.OUTPUT, length=1), "02 95 00 01 00 02 00 01 00"),
    (Boot, Boot.Reply(), "02 97 00 59 65 73 00"),
    (BluetoothGetAddress, BluetoothGetAddress.Reply(ADDRESS), "02 9A 00 00 16 53 01 02 03 00"),
    (
        GetDeviceInfo,
        GetDeviceInfo.Reply("NXT", ADDRESS, link_quality=bytes(4), free_flash=0x00012C00),
        "02 9B 00 4E 58 54" + " 00" * 12 + " 00 16 53 01 02 03 00 00 00 00 00 00 2C 01 00",
    ),
    (PollLength, PollLength.Reply(PollBuffer.USB, available=3), "02 A1 00 00 03"),
    (Poll, Poll.Reply(PollBuffer.USB, count=1, data=b"\x07\x00"), "02 A2 00 00 01 07 00"),
]

TOTAL_LENGTHS = {
    GetOutputState: 25,
    GetInputValues: 16,
    LowSpeedRead: 20,
    MessageRead: 64,
    DatalogRead: 64,
    FindFirstModule: 34,
    GetDeviceInfo: 33,
}


@pytest.mark.parametrize(("request_", "spelled"), REQUESTS, ids=lambda value: type(value).__name__)
def test_a_request_has_the_documented_bytes_both_ways(request_, spelled):
    telegram = bytes.fromhex(spelled)
    assert encode_request(request_) == telegram
    assert decode_request(telegram) == (request_, True)


@pytest.mark.parametrize(("request_", "spelled"), REQUESTS, ids=lambda value: type(value).__name__)
def test_the_no_reply_bit_is_bit_7_of_the_first_byte(request_, spelled):
    telegram = bytearray.fromhex(spelled)
    telegram[0] |= 0x80
    assert encode_request(request_, reply_required=False) == bytes(telegram)
    assert decode_request(bytes(telegram)) == (request_, False)


@pytest.mark.parametrize(("command", "reply", "spelled"), REPLIES)
def test_a_reply_has_the_documented_bytes_both_ways(command, reply, spelled):
    telegram = bytes.fromhex(spelled)
    assert encode_reply(command, reply) == telegram
    assert decode_reply(command, telegram) == reply


def test_every_command_has_a_golden_request():
    assert {type(request) for request, _ in REQUESTS} == set(all_commands())


def test_every_reply_with_data_has_a_golden_telegram():
    with_data = {command.Reply for command in all_commands() if command.Reply is not NoData}
    assert {type(reply) for _, reply, _ in REPLIES} == with_data


def test_commands_without_data_are_answered_with_three_bytes():
    assert encode_reply(StopProgram) == bytes.fromhex("02 01 00")
    assert encode_reply(DeleteUserFlash, DeleteUserFlash.Reply()) == bytes.fromhex("02 A0 00")


@pytest.mark.parametrize(("command", "length"), TOTAL_LENGTHS.items())
def test_long_replies_have_the_documented_length(command, length):
    spelled = next(spelled for golden, _, spelled in REPLIES if golden is command)
    assert len(bytes.fromhex(spelled)) == length


def test_known_values_come_back_with_their_names_and_unknown_ones_as_numbers():
    known = decode_reply(GetOutputState, encode_reply(GetOutputState, OUTPUT_STATE))
    assert isinstance(known.run_state, RunState)
    unknown = decode_request(bytes.fromhex("00 05 00 77 25")).request
    assert unknown == SetInputMode(InputPort.S1, sensor_type=0x77, sensor_mode=SensorMode.BOOLEAN | 5)


def test_padded_replies_give_their_content_without_the_padding():
    assert MessageRead.Reply.of(3, b"hello").message == b"hello"
    assert MessageRead.Reply(3, 0, bytes(59)).message == b""
    assert LowSpeedRead.Reply.of(b"\x01\x00").received == b"\x01\x00"
    assert DatalogRead.Reply(2, b"ab".ljust(60, b"\0")).entry == b"ab"
    assert Poll.Reply(PollBuffer.USB, 1, b"a\0\0").received == b"a"
    assert GetProperty.Reply.of(PropertyId.SLEEP_TIMEOUT, 120_000).value == 120_000
