from __future__ import annotations

import inspect
import pickle

import pytest

from firmware_protocol import (
    BadArgumentError,
    BrickStatusError,
    EndOfFileError,
    FieldValueError,
    GetBatteryLevel,
    GetCurrentProgram,
    GetInputValues,
    GetOutputState,
    GetProperty,
    GetVersions,
    IoMapRead,
    IoMapWrite,
    LoaderError,
    LowSpeedError,
    LowSpeedGetStatus,
    LowSpeedRead,
    MailboxEmptyError,
    MessageRead,
    MessageWrite,
    ModuleError,
    NoProgramError,
    NotYetError,
    OpcodeError,
    PendingError,
    PlayTone,
    PropertyId,
    ProtocolError,
    ReadFile,
    SetBrickName,
    SetOutputState,
    SetProperty,
    StartProgram,
    Status,
    StopProgram,
    TelegramTooShortError,
    TelegramType,
    TelegramTypeError,
    TrailingBytesError,
    UnknownCommandError,
    WriteFile,
    blank_reply,
    decode_answer,
    decode_reply,
    decode_request,
    encode_reply,
    encode_request,
    encode_status,
    errors,
    find_command,
    read_header,
    status_error,
)


def answer_of(command, spelled):
    return decode_reply(command, bytes.fromhex(spelled))


@pytest.mark.parametrize(
    ("command", "spelled", "error"),
    [
        (LowSpeedGetStatus, "02 0E 20 00", PendingError),
        (LowSpeedGetStatus, "02 0E C0", BadArgumentError),
        (LowSpeedRead, "02 10 DD" + " 00" * 17, LowSpeedError),
        (LowSpeedRead, "02 10 C0", BadArgumentError),
        (MessageRead, "02 13 40" + " 00" * 61, MailboxEmptyError),
        (MessageRead, "02 13 EC" + " 00" * 61, NoProgramError),
        (GetOutputState, "02 06 C0" + " 00" * 22, BadArgumentError),
        (GetInputValues, "02 07 C0" + " 00" * 13, BadArgumentError),
        (GetCurrentProgram, "02 11 EC" + " 00" * 20, NoProgramError),
        (StartProgram, "02 00 C0", BadArgumentError),
        (GetProperty, "02 20 BE", UnknownCommandError),
        (WriteFile, "02 83 84 00 05 00", EndOfFileError),
        (IoMapRead, "02 94 90 00 00 00 00 00 00 00 00 00 00", ModuleError),
        (StopProgram, "02 01 77", BrickStatusError),
    ],
)
def test_a_status_other_than_ok_is_raised_as_its_own_error(command, spelled, error):
    with pytest.raises(error) as caught:
        answer_of(command, spelled)
    assert caught.value.status == bytes.fromhex(spelled)[2]
    assert caught.value.command == command.NAME


def test_a_short_read_keeps_the_bytes_that_the_brick_sent():
    with pytest.raises(EndOfFileError) as caught:
        answer_of(ReadFile, "02 82 85 00 04 00 41 42 00 00")
    assert caught.value.reply == ReadFile.Reply(handle=0, length=4, data=b"AB\0\0")


def test_data_of_unexpected_length_behind_an_error_are_dropped_not_complained_about():
    with pytest.raises(BadArgumentError) as caught:
        answer_of(GetOutputState, "02 06 C0 00 00")
    assert caught.value.reply is None
    assert decode_answer(StopProgram, bytes.fromhex("02 01 EC 55 55")).reply is None


def test_an_error_says_command_meaning_and_number_in_one_line():
    with pytest.raises(NoProgramError, match=r"^GET_CURR_PROGRAM: no program is running \(status 0xEC\)$"):
        answer_of(GetCurrentProgram, "02 11 EC")


def test_waiting_is_told_apart_from_failing():
    assert issubclass(PendingError, NotYetError)
    assert issubclass(MailboxEmptyError, NotYetError)
    assert not issubclass(NoProgramError, NotYetError)


@pytest.mark.parametrize("status", [status for status in Status if status is not Status.OK])
def test_every_status_has_a_text_of_its_own_and_a_class_of_its_own_kind(status):
    error = status_error(status)
    assert type(error) is not BrickStatusError
    assert status.text in str(error)
    assert sum(other.text == status.text for other in Status) == 1


@pytest.mark.parametrize("value", range(0x81, 0x94))
def test_file_handle_and_module_errors_are_loader_errors(value):
    assert isinstance(status_error(Status(value)), LoaderError)


def test_an_unknown_status_is_kept():
    unknown = Status(0x77)
    assert unknown == 0x77
    assert unknown.name == "UNKNOWN_77"
    assert "unknown" in unknown.text
    assert type(status_error(unknown)) is BrickStatusError
    assert pickle.loads(pickle.dumps(unknown)) == unknown
    assert encode_reply(StopProgram, status=unknown) == bytes.fromhex("02 01 77")


@pytest.mark.parametrize("value", [-1, 256, "ok", None])
def test_what_is_not_a_byte_is_not_a_status(value):
    with pytest.raises(ValueError, match="is not a valid Status"):
        Status(value)


@pytest.mark.parametrize(
    ("spelled", "error"),
    [
        ("", TelegramTooShortError),
        ("00", TelegramTooShortError),
        ("00 06", TelegramTooShortError),
        ("00 06 00 00", TrailingBytesError),
        ("00 09 00 05 41 00", TelegramTooShortError),
        ("00 09 00 01 00 00", TrailingBytesError),
        ("02 06 00", TelegramTypeError),
        ("03 06 00", TelegramTypeError),
        ("7F 06 00", TelegramTypeError),
        ("00 12", OpcodeError),
        ("00 14", OpcodeError),
        ("00 22 00", OpcodeError),
        ("00 88", OpcodeError),
        ("01 0B", OpcodeError),
        ("01 8A" + " 00" * 20, OpcodeError),
        ("01 A3", OpcodeError),
    ],
)
def test_a_malformed_request_gives_the_error_that_says_why(spelled, error):
    with pytest.raises(error):
        decode_request(bytes.fromhex(spelled))


@pytest.mark.parametrize(
    ("spelled", "error"),
    [
        ("", TelegramTooShortError),
        ("02 0B", TelegramTooShortError),
        ("02 0B 00", TelegramTooShortError),
        ("02 0B 00 00", TelegramTooShortError),
        ("02 0B 00 00 00 00", TrailingBytesError),
        ("00 0B 00 00 00", TelegramTypeError),
        ("02 0C 00", OpcodeError),
    ],
)
def test_a_malformed_reply_gives_the_error_that_says_why(spelled, error):
    with pytest.raises(error):
        answer_of(GetBatteryLevel, spelled)


@pytest.mark.parametrize(
    "request_",
    [
        PlayTone(frequency_hz=-1, duration_ms=0),
        PlayTone(frequency_hz=0x10000, duration_ms=0),
        PlayTone(frequency_hz=440.0, duration_ms=0),
        SetOutputState(0, 128, 0, 0, 0, 0, 0),
        StartProgram("x" * 21),
        StartProgram("a\0b"),
        StartProgram("\u20ac.rxe"),
        StartProgram(None),
        SetBrickName("a name that is too long"),
        MessageWrite(mailbox=0, size=3, data=b"\0"),
        MessageWrite.of(0, b"x" * 256),
        IoMapWrite(0, 0, 1, b""),
        IoMapWrite(0, 0, 1, "a"),
        SetProperty(PropertyId.VOLUME, 256),
        SetProperty(9, 1),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_the_name_of_its_field(request_):
    with pytest.raises(FieldValueError, match=rf"^{type(request_).__name__}\.\w+: "):
        encode_request(request_)


def test_a_reply_of_another_command_is_not_sent():
    with pytest.raises(FieldValueError, match="GET_BATT_LVL"):
        encode_reply(GetBatteryLevel, GetVersions.Reply(124, 1, 29, 1))


def test_a_brick_can_answer_an_opcode_that_it_does_not_know():
    assert encode_status(0x12, Status.UNKNOWN_OPCODE) == bytes.fromhex("02 12 BE")


def test_the_header_of_any_telegram_can_be_read():
    assert read_header(bytes.fromhex("81 EE 00")) == (TelegramType.SYSTEM, 0xEE, False)
    assert read_header(bytes.fromhex("77 00")) == (0x77, 0x00, True)
    with pytest.raises(TelegramTooShortError):
        read_header(b"\0")


def test_an_opcode_counts_only_within_its_kind():
    assert find_command(TelegramType.SYSTEM, 0x88) is GetVersions
    with pytest.raises(OpcodeError):
        find_command(TelegramType.DIRECT, 0x88)


def test_a_telegram_error_is_never_a_status_error():
    assert not issubclass(errors.TelegramError, BrickStatusError)


def test_the_tree_at_the_top_of_errors_is_the_tree_in_the_code():
    drawn = [line.split("── ") for line in inspect.getdoc(errors).splitlines() if "── " in line]
    ancestors = [ProtocolError]
    for branch, text in drawn:
        error = getattr(errors, text.split()[0])
        depth = (len(branch) - 1) // 4
        assert error.__base__ is ancestors[depth - 1]
        ancestors[depth:] = [error]
    classes = [c for c in vars(errors).values() if inspect.isclass(c) and issubclass(c, ProtocolError)]
    assert len(drawn) + 1 == len(classes)


def test_blank_replies_are_what_the_firmware_sends_with_a_bad_port():
    telegram = encode_reply(GetInputValues, blank_reply(GetInputValues), status=Status.VALUE_OUT_OF_RANGE)
    assert telegram == bytes.fromhex("02 07 C0" + " 00" * 13)
