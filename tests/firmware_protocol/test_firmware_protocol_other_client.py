"""nxt-python, an independent client: each side means by its bytes what the other reads from them."""

from __future__ import annotations

import nxt.brick
import nxt.error
import nxt.motor
import nxt.sensor
import pytest

from firmware_protocol import (
    BluetoothFactoryReset,
    Boot,
    CloseFile,
    CloseModule,
    DeleteFile,
    DeleteUserFlash,
    FileFound,
    FileHandle,
    FileOpened,
    FindFirst,
    FindFirstModule,
    FindNext,
    GetBatteryLevel,
    GetCurrentProgram,
    GetDeviceInfo,
    GetInputValues,
    GetOutputState,
    GetVersions,
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
    NoData,
    OpenAppendData,
    OpenRead,
    OpenWrite,
    OpenWriteData,
    OpenWriteLinear,
    PlaySoundFile,
    PlayTone,
    Poll,
    PollLength,
    ReadFile,
    ResetInputScaledValue,
    ResetMotorPosition,
    SetBrickName,
    SetInputMode,
    SetOutputState,
    StartProgram,
    Status,
    StopProgram,
    StopSound,
    TelegramTooShortError,
    WriteFile,
    decode_request,
    decode_request_from_buffer,
    encode_reply,
)


class ScriptedSocket:
    """Answers every request with one prepared reply and keeps the last request."""

    type = "usb"
    bsize = 60

    def __init__(self, reply=None, status=Status.OK):
        self.reply, self.status = reply, status
        self.request, self.reply_required = None, None

    def send(self, data):
        self.request, self.reply_required = decode_request(bytes(data))

    def recv(self):
        return encode_reply(self.request, self.reply, status=self.status)

    def close(self):
        pass


YES, NO = True, False
B, S4 = nxt.motor.Port.B, nxt.sensor.Port.S4
OUTPUT = GetOutputState.Reply(1, -75, 7, 1, -100, 0x20, 720, -1, 2, -3)
INPUT = GetInputValues.Reply(3, YES, NO, 0x0B, 0x00, 1023, 512, -5, 512)
ADDRESS = bytes.fromhex("00165301020300")

CASES = [
    (lambda b: b.start_program("demo.rxe"), StartProgram("demo.rxe"), NoData(), None),
    (lambda b: b.stop_program(), StopProgram(), NoData(), None),
    (lambda b: b.get_battery_level(), GetBatteryLevel(), GetBatteryLevel.Reply(7902), 7902),
    (lambda b: b.keep_alive(), KeepAlive(), KeepAlive.Reply(600_000), 600_000),
    (lambda b: b.stop_sound_playback(), StopSound(), NoData(), None),
    (lambda b: b.reset_input_scaled_value(S4), ResetInputScaledValue(3), NoData(), None),
    (lambda b: b.reset_motor_position(B, YES), ResetMotorPosition(1, YES), NoData(), None),
    (lambda b: b.message_write(3, b"hi"), MessageWrite.of(3, b"hi"), NoData(), None),
    (
        lambda b: b.message_read(10, 0, YES),
        MessageRead(10, 0, YES),
        MessageRead.Reply.of(0, b"hi"),
        (0, b"hi\0"),
    ),
    (lambda b: b.ls_get_status(S4), LowSpeedGetStatus(3), LowSpeedGetStatus.Reply(8), 8),
    (lambda b: b.ls_write(S4, b"\x02\x42", 1), LowSpeedWrite.of(3, b"\x02\x42", 1), NoData(), None),
    (lambda b: b.ls_read(S4), LowSpeedRead(3), LowSpeedRead.Reply.of(b"\x2a\x00"), b"\x2a\x00"),
    (lambda b: b.get_current_program_name(), GetCurrentProgram(), GetCurrentProgram.Reply("a.rxe"), "a.rxe"),
    (
        lambda b: b.get_firmware_version(),
        GetVersions(),
        GetVersions.Reply(124, 1, 29, 1),
        ((1, 124), (1, 29)),
    ),
    (lambda b: b.file_open_read("a.rxe"), OpenRead("a.rxe"), FileOpened(2, 70_000), (2, 70_000)),
    (lambda b: b.file_open_write("a.rxe", 9), OpenWrite("a.rxe", 9), FileHandle(2), 2),
    (lambda b: b.file_open_write_linear("a.rxe", 9), OpenWriteLinear("a.rxe", 9), FileHandle(2), 2),
    (lambda b: b.file_open_write_data("a.txt", 9), OpenWriteData("a.txt", 9), FileHandle(2), 2),
    (lambda b: b.file_open_append_data("a.txt"), OpenAppendData("a.txt"), FileOpened(2, 9), (2, 9)),
    (lambda b: b.file_read(2, 3), ReadFile(2, 3), ReadFile.Reply(2, 3, b"abc"), (2, b"abc")),
    (lambda b: b.file_write(2, b"abc"), WriteFile(2, b"abc"), WriteFile.Reply(2, 3), (2, 3)),
    (lambda b: b.file_close(2), CloseFile(2), FileHandle(2), 2),
    (lambda b: b.file_delete("a.rxe"), DeleteFile("a.rxe"), DeleteFile.Reply("a.rxe"), "a.rxe"),
    (lambda b: b.file_find_first("*.*"), FindFirst("*.*"), FileFound(0, "a.rxe", 9), (0, "a.rxe", 9)),
    (lambda b: b.file_find_next(0), FindNext(0), FileFound(0, "b.rxe", 9), (0, "b.rxe", 9)),
    (
        lambda b: b.module_find_first("*.*"),
        FindFirstModule("*.*"),
        ModuleFound(0, "Ui.mod", ModuleId.UI, 0, 41),
        (0, "Ui.mod", 0x000C0001, 0, 41),
    ),
    (lambda b: b.module_close(0), CloseModule(0), CloseModule.Reply(0), 0),
    (
        lambda b: b.read_io_map(0x00020001, 32, 2),
        IoMapRead(ModuleId.OUTPUT, 32, 2),
        IoMapRead.Reply(ModuleId.OUTPUT, 2, b"ab"),
        (0x00020001, b"ab"),
    ),
    (
        lambda b: b.write_io_map(0x00020001, 32, b"ab"),
        IoMapWrite.of(ModuleId.OUTPUT, 32, b"ab"),
        IoMapWrite.Reply(ModuleId.OUTPUT, 2),
        (0x00020001, 2),
    ),
    (lambda b: b.boot(sure=True), Boot(), Boot.Reply(), b"Yes\0"),
    (
        lambda b: b.get_device_info(),
        GetDeviceInfo(),
        GetDeviceInfo.Reply("NXT", ADDRESS, bytes((1, 2, 3, 4)), 100_000),
        ("NXT", "00:16:53:01:02:03", (1, 2, 3, 4), 100_000),
    ),
    (lambda b: b.delete_user_flash(), DeleteUserFlash(), NoData(), None),
    (lambda b: b.poll_command_length(0), PollLength(0), PollLength.Reply(0, 7), (0, 7)),
    (lambda b: b.poll_command(0, 3), Poll(0, 3), Poll.Reply(0, 2, b"ab\0"), (0, b"ab")),
    (lambda b: b.bluetooth_factory_reset(), BluetoothFactoryReset(), NoData(), None),
]

WITHOUT_REPLY = [
    (lambda b: b.play_sound_file(YES, "a.rso"), PlaySoundFile(YES, "a.rso")),
    (lambda b: b.play_tone(440, 1000), PlayTone(440, 1000)),
    (
        lambda b: b.set_output_state(
            B,
            -75,
            nxt.motor.Mode.ON | nxt.motor.Mode.BRAKE,
            nxt.motor.RegulationMode.SYNC,
            -100,
            nxt.motor.RunState.RUNNING,
            720,
        ),
        SetOutputState(1, -75, 3, 2, -100, 0x20, 720),
    ),
    (
        lambda b: b.set_input_mode(S4, nxt.sensor.Type.LOW_SPEED_9V, nxt.sensor.Mode.RAW),
        SetInputMode(3, 0x0B, 0x00),
    ),
]


@pytest.mark.parametrize(("call", "meant", "reply", "result"), CASES)
def test_what_another_client_asks_and_understands(call, meant, reply, result):
    socket = ScriptedSocket(reply)
    assert call(nxt.brick.Brick(socket)) == result
    assert socket.request == meant
    assert socket.reply_required


@pytest.mark.parametrize(("call", "meant"), WITHOUT_REPLY)
def test_what_another_client_tells_without_waiting(call, meant):
    socket = ScriptedSocket()
    call(nxt.brick.Brick(socket))
    assert socket.request == meant
    assert socket.reply_required is False


def test_another_client_sends_a_name_one_byte_short_as_the_firmware_allows():
    telegrams = []
    socket = ScriptedSocket()
    socket.send = telegrams.append
    socket.recv = lambda: encode_reply(SetBrickName)
    nxt.brick.Brick(socket).set_brick_name("NXT")
    telegram = bytes(telegrams[0])
    with pytest.raises(TelegramTooShortError):
        decode_request(telegram)
    buffer = telegram.ljust(128, b"\0")
    assert decode_request_from_buffer(buffer, len(telegram)).request == SetBrickName("NXT")


def test_another_client_reads_a_motors_state():
    port, power, mode, regulation, turn, run_state, limit, count, block, rotation = nxt.brick.Brick(
        ScriptedSocket(OUTPUT)
    ).get_output_state(B)
    assert (port, power, mode.value, regulation.value, turn) == (B, -75, 7, 1, -100)
    assert (run_state.value, limit, count, block, rotation) == (0x20, 720, -1, 2, -3)


def test_another_client_reads_a_sensors_values():
    port, valid, calibrated, kind, mode, *readings = nxt.brick.Brick(ScriptedSocket(INPUT)).get_input_values(
        S4
    )
    assert (port, valid, calibrated, kind.value, mode.value) == (S4, True, False, 0x0B, 0x00)
    assert readings == [1023, 512, -5, 512]


@pytest.mark.parametrize(
    ("status", "error"),
    [
        (Status.PENDING, nxt.error.I2CPendingError),
        (Status.FILE_NOT_FOUND, nxt.error.FileNotFoundError),
        (Status.NO_ACTIVE_PROGRAM, nxt.error.NoActiveProgramError),
    ],
)
def test_another_client_understands_our_statuses(status, error):
    with pytest.raises(error):
        nxt.brick.Brick(ScriptedSocket(status=status)).stop_program()
