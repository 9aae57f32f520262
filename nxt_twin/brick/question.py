"""A request made ready: its telegram, how its reply starts, and what reads the reply."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, Generic, TypeVar, cast, final

from firmware_protocol import (
    Command,
    FieldValueError,
    IoMapWrite,
    ModuleId,
    MotorMode,
    ReplyData,
    SetOutputState,
    Status,
    TelegramError,
    TelegramType,
    decode_reply,
    encode_request,
)
from firmware_protocol.layout import fields_of
from firmware_protocol.wire import Number, Truth, Wire
from nxt_twin.brick.errors import RequestError

T = TypeVar("T")
ReplyT = TypeVar("ReplyT", bound=ReplyData)

_ECHOES: Final = ("port", "handle", "buffer", "module_id")
"""Fields that a reply opens with and that repeat the request's, so that they tell whose reply it is."""
_STRUCT_CODES: Final = {1: "B", 2: "H", 4: "I"}


@final
@dataclass(frozen=True)
class Question(Generic[T]):
    """A request that can be put to the brick any number of times.

    Attributes:
        request: what is asked.
        telegram: its bytes.
        head: how a reply to it starts that has status OK: type, opcode, status and what is repeated.
        read: makes the value out of such a reply; raises the wire language's errors.
        engages: whether a motor may run or be held after it.
        mends: whether it is put to bring requests and replies together, and so in whatever state they are.
    """

    request: Command[Any]
    telegram: bytes
    head: bytes
    read: Callable[[bytes], T]
    engages: bool
    mends: bool = False


def question(request: Command[ReplyT]) -> Question[ReplyT]:
    """Make any request ready; the value is its reply's data.

    Raises:
        RequestError: a value does not fit its field.
    """
    return _ready(request, lambda telegram: decode_reply(request, telegram))


def compiled_question(request: Command[Any], make: Callable[..., T]) -> Question[T]:
    """Make a request ready that is put often; the reply is read several times faster.

    Args:
        request: what is asked; its reply has only numbers, and single bytes with names.
        make: is called with the reply's values, in the order of the wire.

    Raises:
        RequestError: a value does not fit its field.
    """
    return _ready(request, _compiled_reader(request, make))


def _ready(request: Command[Any], read: Callable[[bytes], T]) -> Question[T]:
    try:
        telegram = encode_request(request)
    except FieldValueError as error:
        raise RequestError(str(error), where=request.NAME) from error
    head = bytes((TelegramType.REPLY, request.OPCODE, Status.OK)) + _echo(request)
    return Question(request, telegram, head, read, engages=_engages(request))


def _echo(request: Command[Any]) -> bytes:
    opening = fields_of(request.Reply)[:1]
    asked = vars(request)
    if not opening or opening[0].name not in _ECHOES or opening[0].name not in asked:
        return b""
    return opening[0].wire.pack(asked[opening[0].name], opening[0].wire.width({}, 0))


def _compiled_reader(request: Command[Any], make: Callable[..., T]) -> Callable[[bytes], T]:
    """Read by one struct, and give names by tables: both follow from the reply's declaration."""
    wires = [field.wire for field in fields_of(request.Reply)]
    unpack = struct.Struct(f"<3x{''.join(_code(wire) for wire in wires)}").unpack
    build = _builder(make)
    ok = int(Status.OK)
    named = [
        (at, tuple(wire.unpack(bytes((byte,))) for byte in range(256)))
        for at, wire in enumerate(wires)
        if not isinstance(wire, (Number, Truth))
    ]

    def read(telegram: bytes) -> T:
        try:
            values = list(unpack(telegram))
            if telegram[2] == ok:
                for at, names in named:
                    values[at] = names[values[at]]
                return build(values)
        except struct.error:
            pass
        decode_reply(request, telegram)  # raises what is wrong with it
        raise TelegramError(f"{telegram.hex(' ')} is no reply to {request.NAME}")

    return read


def _builder(make: Callable[..., T]) -> Callable[[list[Any]], T]:
    """What calls it with a list of values; a named tuple is built without the detour by names."""
    if isinstance(make, type) and issubclass(make, tuple) and hasattr(make, "_fields"):
        return cast("Callable[[list[Any]], T]", partial(tuple.__new__, make))
    return lambda values: make(*values)


def _code(wire: Wire) -> str:
    if isinstance(wire, Truth):
        return "?"
    code = _STRUCT_CODES[wire.width({}, 0)]
    return code.lower() if isinstance(wire, Number) and wire.signed else code


def _engages(request: Command[Any]) -> bool:
    if isinstance(request, SetOutputState):
        return request.mode != MotorMode.COAST
    return isinstance(request, IoMapWrite) and request.module_id == ModuleId.OUTPUT
