"""Digital sensors, on the I2C bus that LEGO calls low speed: start, ask, fetch.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands, cCmdLSWrite, and c_lowspeed.c.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self, final

from firmware_protocol.command import DirectCommand, NoData, ReplyData
from firmware_protocol.fields import U8, Bytes16, InputPort8
from firmware_protocol.limits import LOW_SPEED_BUFFER_SIZE
from firmware_protocol.wire import Counted


@final
@dataclass(frozen=True)
class LowSpeedGetStatus(DirectCommand["LowSpeedGetStatus.Reply"], opcode=0x0E, name="LS_GET_STATUS"):
    """Ask how many received bytes wait; the status is pending while the transaction runs."""

    port: InputPort8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The number of bytes that wait; 16 look like 0."""

        bytes_ready: U8


@final
@dataclass(frozen=True)
class LowSpeedWrite(DirectCommand[NoData], opcode=0x0F, name="LS_WRITE"):
    """Start a transaction: send bytes, the address first, then receive ``receive_length`` bytes."""

    port: InputPort8
    send_length: U8
    receive_length: U8
    data: Annotated[bytes, Counted("send_length")]

    @classmethod
    def of(cls, port: int, data: bytes, receive_length: int) -> Self:
        """The request that sends these bytes (at most 16)."""
        return cls(port, len(data), receive_length, data)


@final
@dataclass(frozen=True)
class LowSpeedRead(DirectCommand["LowSpeedRead.Reply"], opcode=0x10, name="LS_READ"):
    """Fetch all received bytes; a port above 3 gives an error without data."""

    port: InputPort8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The bytes, padded with zeros; `received` is without the padding."""

        count: U8
        data: Bytes16

        @classmethod
        def of(cls, received: bytes) -> Self:
            """The reply that carries these bytes (at most 16)."""
            return cls(len(received), received.ljust(LOW_SPEED_BUFFER_SIZE, b"\0"))

        @property
        def received(self) -> bytes:
            """The bytes that the sensor sent."""
            return self.data[: self.count]
