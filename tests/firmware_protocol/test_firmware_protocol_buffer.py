"""What a brick without length checks makes of telegrams that are too short or too long."""

from __future__ import annotations

import pytest

from firmware_protocol import (
    GetOutputState,
    IoMapWrite,
    LowSpeedWrite,
    MessageWrite,
    OpcodeError,
    PropertyId,
    SetOutputState,
    SetProperty,
    StartProgram,
    TelegramTooShortError,
    TelegramTypeError,
    WriteFile,
    decode_request_from_buffer,
    encode_request,
)


def buffer_after(*telegrams: bytes) -> bytes:
    buffer = bytearray(128)
    for telegram in telegrams:
        buffer[: len(telegram)] = telegram
    return bytes(buffer)


def test_missing_bytes_come_from_the_telegram_before():
    full = encode_request(SetOutputState(0, 50, 1, 0, 0, 0x20, 360))
    cut = bytes.fromhex("00 04 02 CE")
    request, _ = decode_request_from_buffer(buffer_after(full, cut), len(cut))
    assert request == SetOutputState(2, -50, 1, 0, 0, 0x20, 360)


def test_superfluous_bytes_are_ignored():
    telegram = bytes.fromhex("80 06 01 99 99")
    assert decode_request_from_buffer(buffer_after(telegram), 5) == (GetOutputState(1), False)


def test_one_zero_byte_starts_the_program_whose_name_is_left_in_the_buffer():
    earlier = encode_request(StartProgram("demo.rxe"))
    request, _ = decode_request_from_buffer(buffer_after(earlier, b"\0"), 1)
    assert request == StartProgram("demo.rxe")


def test_file_data_end_with_the_telegram_not_with_the_buffer():
    telegram = bytes.fromhex("01 83 00 AA BB")
    assert decode_request_from_buffer(buffer_after(telegram), 5).request == WriteFile(0, b"\xaa\xbb")
    assert decode_request_from_buffer(buffer_after(telegram), 2).request == WriteFile(0, b"")


def test_a_value_stands_at_its_place_even_if_the_telegram_ends_before_it():
    earlier = bytes.fromhex("00 1F 02 60 EA 00 00")
    request, _ = decode_request_from_buffer(buffer_after(earlier, b"\x00\x1f\x02"), 3)
    assert request == SetProperty(PropertyId.SLEEP_TIMEOUT, 60_000)


@pytest.mark.parametrize(
    ("spelled", "request_"),
    [
        ("00 09 00 00", MessageWrite(0, 0, b"")),
        ("00 09 00 FF", MessageWrite(0, 255, bytes(255))),
        ("00 0F 00 C8 FF", LowSpeedWrite(0, 200, 255, bytes(200))),
        ("01 95 01 00 02 00 00 00 FF FF", IoMapWrite(0x00020001, 0, 0xFFFF, bytes(0xFFFF))),
    ],
)
def test_announced_sizes_that_the_brick_will_refuse_can_still_be_read(spelled, request_):
    telegram = bytes.fromhex(spelled)
    assert decode_request_from_buffer(buffer_after(telegram), len(telegram)).request == request_


@pytest.mark.parametrize(
    ("spelled", "error"),
    [("05 00", TelegramTypeError), ("00 12", OpcodeError), ("00", TelegramTooShortError)],
)
def test_only_type_and_opcode_can_be_wrong(spelled, error):
    with pytest.raises(error):
        decode_request_from_buffer(bytes.fromhex(spelled), 2)
