"""Mailboxes: messages to and from the program that runs on the brick.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands, cCmdMessageWrite, cCmdMessageGetSize.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self, final

from firmware_protocol.command import DirectCommand, NoData, ReplyData
from firmware_protocol.fields import U8, Bool8
from firmware_protocol.limits import MESSAGE_SIZE
from firmware_protocol.wire import Counted, FixedBytes


@final
@dataclass(frozen=True)
class MessageWrite(DirectCommand[NoData], opcode=0x09, name="MESSAGE_WRITE"):
    """Put a message into a mailbox; the last byte has to be NUL and the size counts it."""

    mailbox: U8
    size: U8
    data: Annotated[bytes, Counted("size")]

    @classmethod
    def of(cls, mailbox: int, message: bytes) -> Self:
        """The request that carries a message, given without its final NUL (at most 58 bytes fit)."""
        return cls(mailbox, len(message) + 1, message + b"\0")


@final
@dataclass(frozen=True)
class MessageRead(DirectCommand["MessageRead.Reply"], opcode=0x13, name="MESSAGE_READ"):
    """Take the oldest message out of a mailbox, or only look at it.

    A brick accepts the reply unasked as well: that is how bricks send messages to each other.
    """

    remote_mailbox: U8
    local_mailbox: U8
    remove: Bool8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The local mailbox, and the message padded with zeros; the size counts its final NUL."""

        mailbox: U8
        size: U8
        data: Annotated[bytes, FixedBytes(MESSAGE_SIZE)]

        @classmethod
        def of(cls, mailbox: int, message: bytes) -> Self:
            """The reply that carries a message, given without its final NUL (at most 58 bytes fit)."""
            return cls(mailbox, len(message) + 1, message.ljust(MESSAGE_SIZE, b"\0"))

        @property
        def message(self) -> bytes:
            """The message without its final NUL and padding."""
            return self.data[: max(0, self.size - 1)]
