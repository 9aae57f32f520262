"""Telegrams: requests and replies to bytes and back, strictly; and requests as the firmware reads them.

A request is ``type opcode fields…``, a reply ``02 opcode status fields…``. Type bit 7: no reply wanted.
Source: LEGO NXT firmware 1.29, c_comm.c cCommInterprete and c_cmd.c cCmdHandleRemoteCommands.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Generic, NamedTuple, TypeAlias, TypeVar, cast, final

from firmware_protocol.command import Command, ReplyData
from firmware_protocol.enums import TelegramType
from firmware_protocol.errors import (
    FieldValueError,
    OpcodeError,
    TelegramError,
    TelegramTooShortError,
    TelegramTypeError,
    status_error,
)
from firmware_protocol.layout import pack, unpack, unpack_loosely
from firmware_protocol.registry import find_command
from firmware_protocol.status import Status

_NO_REPLY: Final = 0x80
_REQUEST_HEADER_SIZE: Final = 2
_REPLY_HEADER_SIZE: Final = 3

ReplyT = TypeVar("ReplyT", bound=ReplyData)
AnyCommand: TypeAlias = Command[ReplyT] | type[Command[ReplyT]]
"""A request, or its class: either says which command is meant."""


class Header(NamedTuple):
    """The first two bytes of a telegram; types and opcodes that nobody knows are kept as they are."""

    kind: int
    opcode: int
    reply_required: bool


class DecodedRequest(NamedTuple):
    """A request, and whether the sender waits for a reply."""

    request: Command[Any]
    reply_required: bool


@final
@dataclass(frozen=True)
class Answer(Generic[ReplyT]):
    """A reply as it came, successful or not.

    Args:
        status: the status byte.
        reply: the data; None where the brick sent a status with no data, or not all of them.
    """

    status: Status
    reply: ReplyT | None


def read_header(telegram: bytes) -> Header:
    """The type, opcode and no-reply bit of any telegram.

    Raises:
        TelegramTooShortError: there are fewer than two bytes.
    """
    if len(telegram) < _REQUEST_HEADER_SIZE:
        raise TelegramTooShortError(
            f"a telegram has a type and an opcode, but this has {len(telegram)} bytes"
        )
    return Header(telegram[0] & ~_NO_REPLY, telegram[1], not telegram[0] & _NO_REPLY)


def encode_request(request: Command[Any], *, reply_required: bool = True) -> bytes:
    """The telegram of a request.

    Raises:
        FieldValueError: a value does not fit its field.
    """
    kind = request.KIND if reply_required else request.KIND | _NO_REPLY
    return bytes((kind, request.OPCODE)) + pack(request)


def decode_request(telegram: bytes) -> DecodedRequest:
    """The request of a telegram that has to be complete and end with its last field.

    Raises:
        TelegramTypeError: it is not a direct or system command.
        OpcodeError: the firmware implements no such command.
        TelegramTooShortError: it ends before the last field does.
        TrailingBytesError: it goes on after the last field.
    """
    command, reply_required = _command_of(telegram)
    return DecodedRequest(unpack(command, telegram[_REQUEST_HEADER_SIZE:]), reply_required)


def decode_request_from_buffer(buffer: bytes, length: int) -> DecodedRequest:
    """The request that the firmware sees in its receive buffer: it checks no lengths.

    Fields stand at fixed offsets, whatever the telegram's length: missing ones are read from what earlier
    telegrams left in the buffer, superfluous bytes are ignored. Only a field that takes all remaining bytes
    (the data of WRITE) ends with the telegram. Beyond the buffer's end zeros are read.

    Args:
        buffer: the whole receive buffer, the telegram at its start.
        length: how many bytes the telegram has.

    Raises:
        TelegramTypeError: it is not a direct or system command.
        OpcodeError: the firmware implements no such command.
        TelegramTooShortError: the buffer has fewer than two bytes.
    """
    command, reply_required = _command_of(buffer)
    request = unpack_loosely(command, buffer, start=_REQUEST_HEADER_SIZE, end=length)
    return DecodedRequest(request, reply_required)


def encode_status(opcode: int, status: Status) -> bytes:
    """A reply that ends with its status, to any opcode, known or not."""
    return bytes((TelegramType.REPLY, opcode, status))


def encode_reply(
    command: AnyCommand[ReplyT], reply: ReplyT | None = None, *, status: Status = Status.OK
) -> bytes:
    """The telegram of a reply.

    Args:
        command: the request that is answered, or its class.
        reply: the data, of class ``command.Reply``; None for a reply that ends with its status.
        status: the status byte; the firmware sends data with some errors too (see `blank_reply`).

    Raises:
        FieldValueError: a value does not fit its field, or the reply is another command's.
    """
    header = encode_status(command.OPCODE, status)
    if reply is None:
        return header
    if not isinstance(reply, command.Reply):
        raise FieldValueError(f"{command.NAME} is answered with {command.Reply.__qualname__}, not {reply!r}")
    return header + pack(reply)


def decode_reply(command: AnyCommand[ReplyT], telegram: bytes) -> ReplyT:
    """The data of a successful reply.

    Args:
        command: the request that was sent, or its class.
        telegram: what the brick answered.

    Raises:
        BrickStatusError: the status is not OK; the class tells the kind (see `errors`), ``reply`` holds the
            data if the brick sent all of them.
        TelegramTypeError: it is not a reply.
        OpcodeError: it answers another command.
        TelegramTooShortError: it ends before the last field does.
        TrailingBytesError: it goes on after the last field.
    """
    answer = decode_answer(command, telegram)
    if answer.status is not Status.OK or answer.reply is None:
        raise status_error(answer.status, command=command.NAME, reply=answer.reply)
    return answer.reply


def decode_answer(command: AnyCommand[ReplyT], telegram: bytes) -> Answer[ReplyT]:
    """The status and data of a reply, for those who want to look at failures without exceptions.

    Data behind a status other than OK may be missing, complete or neither: if not complete they are dropped.

    Raises:
        TelegramTypeError: it is not a reply.
        OpcodeError: it answers another command.
        TelegramTooShortError: a successful reply ends before the last field does.
        TrailingBytesError: a successful reply goes on after the last field.
    """
    header = read_header(telegram)
    if header.kind != TelegramType.REPLY:
        raise TelegramTypeError(f"a reply has type 0x02, this telegram 0x{telegram[0]:02X}")
    if header.opcode != command.OPCODE:
        raise OpcodeError(
            f"{command.NAME} has opcode 0x{command.OPCODE:02X}, the reply is to 0x{header.opcode:02X}"
        )
    if len(telegram) < _REPLY_HEADER_SIZE:
        raise TelegramTooShortError(f"the reply to {command.NAME} has no status")
    status = Status(telegram[2])
    reply_type = cast("type[ReplyT]", command.Reply)
    try:
        return Answer(status, unpack(reply_type, telegram[_REPLY_HEADER_SIZE:]))
    except TelegramError:
        if status is Status.OK:
            raise
        return Answer(status, None)


def blank_reply(command: AnyCommand[ReplyT]) -> ReplyT:
    """The reply of which every byte is 0, as the firmware sends it with many errors."""
    return cast("ReplyT", _blank(command.Reply))


@cache
def _blank(reply: type[ReplyData]) -> ReplyData:
    return unpack_loosely(reply, b"", start=0, end=0)


def _command_of(telegram: bytes) -> tuple[type[Command[Any]], bool]:
    header = read_header(telegram)
    if header.kind not in (TelegramType.DIRECT, TelegramType.SYSTEM):
        raise TelegramTypeError(f"a request has type 0x00, 0x01, 0x80 or 0x81, not 0x{telegram[0]:02X}")
    return find_command(header.kind, header.opcode), header.reply_required
