from __future__ import annotations

import pytest
from firmware_protocol_strategies import requests, structures
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol import (
    BrickStatusError,
    Status,
    TelegramError,
    all_commands,
    blank_reply,
    decode_answer,
    decode_reply,
    decode_request,
    decode_request_from_buffer,
    encode_reply,
    encode_request,
)

commands = st.sampled_from(all_commands())
statuses = st.integers(0, 255).map(Status)


@given(requests(), st.booleans())
def test_a_request_survives_the_wire(request_, reply_required):
    telegram = encode_request(request_, reply_required=reply_required)
    assert decode_request(telegram) == (request_, reply_required)


@given(st.data(), commands)
def test_a_reply_survives_the_wire(data, command):
    reply = data.draw(structures(command.Reply))
    assert decode_reply(command, encode_reply(command, reply)) == reply


@given(st.data(), commands, statuses)
def test_a_status_and_its_data_survive_the_wire(data, command, status):
    reply = data.draw(structures(command.Reply))
    answer = decode_answer(command, encode_reply(command, reply, status=status))
    assert (answer.status, answer.reply) == (status, reply)


@given(requests(), st.binary(max_size=64))
def test_a_lenient_reader_sees_the_same_request_whatever_else_is_in_the_buffer(request_, stale):
    telegram = encode_request(request_)
    assert decode_request_from_buffer(telegram + stale, len(telegram)) == decode_request(telegram)


@given(st.binary(max_size=80))
def test_any_bytes_are_a_request_or_a_telegram_error(telegram):
    try:
        request, reply_required = decode_request(telegram)
    except TelegramError:
        return
    assert decode_request(encode_request(request, reply_required=reply_required)).request == request


@given(commands, st.binary(max_size=70))
def test_any_bytes_behind_a_commands_header_are_a_request_or_a_telegram_error(command, rest):
    try:
        request, _ = decode_request(bytes((command.KIND, command.OPCODE)) + rest)
    except TelegramError:
        return
    assert isinstance(request, command)


@given(commands, st.binary(max_size=80))
def test_any_bytes_are_a_reply_or_a_documented_error(command, telegram):
    try:
        decode_reply(command, telegram)
    except (TelegramError, BrickStatusError):
        return
    assert telegram[:3] in (bytes((0x02, command.OPCODE, 0)), bytes((0x82, command.OPCODE, 0)))


@given(commands, statuses, st.binary(max_size=80))
def test_any_bytes_behind_a_status_are_a_reply_or_a_documented_error(command, status, rest):
    telegram = bytes((0x02, command.OPCODE, status)) + rest
    try:
        answer = decode_answer(command, telegram)
    except TelegramError:
        assert status is Status.OK
        return
    assert answer.status == status


@given(commands, st.binary(max_size=128), st.integers(0, 200))
def test_a_lenient_reader_never_fails_on_a_known_opcode(command, rest, length):
    buffer = bytes((command.KIND, command.OPCODE)) + rest
    request, reply_required = decode_request_from_buffer(buffer, length)
    assert isinstance(request, command)
    assert reply_required
    assert decode_request(encode_request(request)).request == request


@pytest.mark.parametrize("command", all_commands(), ids=lambda command: command.NAME)
def test_a_blank_reply_is_all_zeros(command):
    telegram = encode_reply(command, blank_reply(command), status=Status.VALUE_OUT_OF_RANGE)
    assert telegram[:3] == bytes((0x02, command.OPCODE, 0xC0))
    assert not any(telegram[3:])
