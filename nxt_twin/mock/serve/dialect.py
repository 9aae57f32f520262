"""How a client over TCP marks where telegrams end: a length before each, or nxt-python's way, which is not at all."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final, final

from firmware_protocol import OpcodeError, Status, TelegramType, find_command, frame
from firmware_protocol.bluetooth import LENGTH_PREFIX_SIZE
from firmware_protocol.layout import fixed_size_of
from nxt_twin.mock.firmware.channel import Transport

_HELLO: Final = 0x98
_BYE: Final = 0x99
_NO_REPLY: Final = 0x80
_HEADER_SIZE: Final = 2
_REFUSAL: Final = b"this mock brick is framed; start it with --tcp-raw"
_OTHER: Final = b"another client is connected"


@final
@dataclass(frozen=True)
class Heard:
    """What bytes from a client mean.

    Attributes:
        parts: what the brick gets.
        answer: what the client gets at once, from whoever carries the telegrams.
        bye: whether the connection ends behind it.
    """

    parts: tuple[bytes, ...]
    answer: bytes = b""
    bye: bool = False


class Dialect(ABC):
    """Abstract: what clients speak at a place.

    Attributes:
        scheme: what stands before HOST:PORT.
        transport: the brick's way in.
    """

    scheme: str
    transport: Transport

    @abstractmethod
    def hear(self, data: bytes, *, first: bool) -> Heard:
        """What these bytes mean; `first` says that the connection has just begun."""

    @abstractmethod
    def rest(self, data: bytes) -> bytes:
        """What of a stream, from the beginning of a telegram on, is the beginning of one that is not whole yet."""

    @abstractmethod
    def busy(self, data: bytes) -> bytes:
        """The answer to a client that may not be served, for what it sent first."""


@final
class Framed(Dialect):
    """A two-byte length before each telegram, as on Bluetooth; the brick's firmware cuts the stream.

    A client that greets in nxt-python's way is told so and hung up on: it would wait for ever.
    """

    scheme = "tcp"
    transport = Transport.BLUETOOTH

    def hear(self, data: bytes, *, first: bool) -> Heard:
        """The stream as it is."""
        if first and data == bytes((_HELLO,)):
            return Heard((), _REFUSAL, bye=True)
        return Heard((data,))

    def rest(self, data: bytes) -> bytes:
        """Behind the last whole frame."""
        while len(data) >= LENGTH_PREFIX_SIZE:
            end = LENGTH_PREFIX_SIZE + int.from_bytes(data[:LENGTH_PREFIX_SIZE], "little")
            if len(data) < end:
                break
            data = data[end:]
        return data

    def busy(self, data: bytes) -> bytes:
        """A refusal in a frame; words for who greets in the other way."""
        if data == bytes((_HELLO,)):
            return _OTHER
        refusal = _refusal(data[LENGTH_PREFIX_SIZE:])
        return frame(refusal) if refusal else b""


@final
class Unframed(Dialect):
    """What nxt-python's socket backend speaks to its `nxt-server`: each send is a telegram, replies likewise.

    A greeting asks for the kind of link, a farewell ends the connection. Telegrams that arrive at once are told
    apart by their commands' sizes, where these are fixed.

    Source: nxt-python 3.5, nxt/backend/socket.py and nxt/command/server.py.
    """

    scheme = "tcp-raw"
    transport = Transport.USB

    def hear(self, data: bytes, *, first: bool) -> Heard:
        """Telegrams, one by one."""
        del first
        answer = b""
        if data[:1] == bytes((_HELLO,)):
            answer, data = b"usb", data[1:]
        parts: list[bytes] = []
        while data and data[0] != _BYE:
            size = _telegram_size(data)
            parts.append(data[:size])
            data = data[size:]
        return Heard(tuple(parts), answer, bye=bool(data))

    def rest(self, data: bytes) -> bytes:
        """Nothing: whatever arrives at once is whole."""
        del data
        return b""

    def busy(self, data: bytes) -> bytes:
        """Words for a greeting, a refusal for a telegram."""
        return _OTHER if data[:1] == bytes((_HELLO,)) else _refusal(data)


def _refusal(telegram: bytes) -> bytes:
    """The reply that a busy radio gives; empty where none is wanted."""
    if len(telegram) < _HEADER_SIZE or telegram[0] & _NO_REPLY:
        return b""
    return bytes((TelegramType.REPLY, telegram[1], Status.BLUETOOTH_BUSY))


def _telegram_size(data: bytes) -> int:
    """How long the first telegram is: its command's size, if another telegram stands behind that; else all."""
    try:
        command = find_command(data[0] & ~_NO_REPLY, data[1])
    except (OpcodeError, IndexError):
        return len(data)
    body = fixed_size_of(command)
    size = len(data) if body is None else _HEADER_SIZE + body
    behind = data[size : size + 1]
    known = behind and (
        behind[0] == _BYE or behind[0] & ~_NO_REPLY in (TelegramType.DIRECT, TelegramType.SYSTEM)
    )
    return size if known else len(data)
