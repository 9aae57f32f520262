"""Programs on the brick: start, stop, ask which one runs, and the datalog that they write.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, final

from firmware_protocol.command import DirectCommand, NoData, ReplyData
from firmware_protocol.fields import S32, U8, Bool8, Name20
from firmware_protocol.limits import DATALOG_SIZE
from firmware_protocol.wire import FixedBytes


@final
@dataclass(frozen=True)
class StartProgram(DirectCommand[NoData], opcode=0x00, name="START_PROGRAM"):
    """Ask for a program to be started.

    OK says only that the file exists: the start comes later, and a damaged file gives OK too.
    """

    name: Name20


@final
@dataclass(frozen=True)
class StopProgram(DirectCommand[NoData], opcode=0x01, name="STOP_PROGRAM"):
    """Ask for the running program to be stopped; the stop comes after the reply."""


@final
@dataclass(frozen=True)
class GetCurrentProgram(DirectCommand["GetCurrentProgram.Reply"], opcode=0x11, name="GET_CURR_PROGRAM"):
    """Ask which program runs; an error without one, followed by 20 zeros."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The running program's file name."""

        name: Name20


@final
@dataclass(frozen=True)
class DatalogRead(DirectCommand["DatalogRead.Reply"], opcode=0x19, name="DATALOG_READ"):
    """Read the oldest entry of the datalog, and optionally remove it."""

    remove: Bool8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """An entry, padded with zeros; `entry` is without the padding."""

        size: U8
        data: Annotated[bytes, FixedBytes(DATALOG_SIZE)]

        @property
        def entry(self) -> bytes:
            """The entry's own bytes."""
            return self.data[: self.size]


@final
@dataclass(frozen=True)
class DatalogSetTimes(DirectCommand[NoData], opcode=0x1A, name="DATALOG_SET_TIMES"):
    """Set the datalog's clock."""

    sync_time: S32
