"""Firmware modules: find them, read and write their IO maps (see `iomap` for what the maps hold).

Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd and c_loader.c cLoaderFileRq.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self, final

from firmware_protocol.command import ReplyData, SystemCommand
from firmware_protocol.fields import U8, U16, U32, ModuleId32, Name20, Rest
from firmware_protocol.wire import Counted


@final
@dataclass(frozen=True)
class ModuleFound(ReplyData):
    """A module, such as ``Output.mod``, and the size of its IO map. On an error, zeros."""

    handle: U8
    name: Name20
    module_id: ModuleId32
    size: U32
    io_map_size: U16


@final
@dataclass(frozen=True)
class FindFirstModule(SystemCommand[ModuleFound], opcode=0x90, name="FIND_FIRST_MODULE"):
    """Start a search for modules; only one search at a time, until CLOSE_MODULE ends it."""

    Reply = ModuleFound
    pattern: Name20


@final
@dataclass(frozen=True)
class FindNextModule(SystemCommand[ModuleFound], opcode=0x91, name="FIND_NEXT_MODULE"):
    """Go on with the search."""

    Reply = ModuleFound
    handle: U8


@final
@dataclass(frozen=True)
class CloseModule(SystemCommand["CloseModule.Reply"], opcode=0x92, name="CLOSE_MODULE"):
    """End the search; needed after one that found nothing, too."""

    handle: U8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The search handle, always 0."""

        handle: U8


@final
@dataclass(frozen=True)
class IoMapRead(SystemCommand["IoMapRead.Reply"], opcode=0x94, name="IOMAP_READ"):
    """Read bytes of a module's IO map; at most 55 over USB and 119 over Bluetooth, more is cut."""

    module_id: ModuleId32
    offset: U16
    length: U16

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The bytes; on an error the length is 0 and the data are as many zeros as were requested."""

        module_id: ModuleId32
        length: U16
        data: Rest


@final
@dataclass(frozen=True)
class IoMapWrite(SystemCommand["IoMapWrite.Reply"], opcode=0x95, name="IOMAP_WRITE"):
    """Write bytes into a module's IO map."""

    module_id: ModuleId32
    offset: U16
    length: U16
    data: Annotated[bytes, Counted("length")]

    @classmethod
    def of(cls, module_id: int, offset: int, data: bytes) -> Self:
        """The request that writes these bytes."""
        return cls(module_id, offset, len(data), data)

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """How many bytes were written."""

        module_id: ModuleId32
        length: U16
