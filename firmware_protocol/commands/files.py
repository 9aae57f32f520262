"""Files: open, read, write, close, find, delete.

Names have at most 19 characters (see `check_file_name`); upper and lower case are the same name.
Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd, c_loader.c cLoaderFileRq and d_loader.c.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from firmware_protocol.command import NoData, ReplyData, SystemCommand
from firmware_protocol.fields import U8, U16, U32, Name20, Rest


@final
@dataclass(frozen=True)
class FileHandle(ReplyData):
    """The handle that was opened or closed."""

    handle: U8


@final
@dataclass(frozen=True)
class FileOpened(ReplyData):
    """The new handle, and the number of bytes that it gives access to."""

    handle: U8
    size: U32


@final
@dataclass(frozen=True)
class FileFound(ReplyData):
    """A search handle to go on with, and one file; the size is the allocated one. On an error, zeros."""

    handle: U8
    name: Name20
    size: U32


@final
@dataclass(frozen=True)
class OpenRead(SystemCommand[FileOpened], opcode=0x80, name="OPEN_READ"):
    """Open a file for reading; the size is that of its data. An empty file counts as missing."""

    Reply = FileOpened
    name: Name20


@final
@dataclass(frozen=True)
class OpenWrite(SystemCommand[FileHandle], opcode=0x81, name="OPEN_WRITE"):
    """Create a file of a fixed size; programs and system files are laid out in one piece by themselves."""

    Reply = FileHandle
    name: Name20
    size: U32


@final
@dataclass(frozen=True)
class ReadFile(SystemCommand["ReadFile.Reply"], opcode=0x82, name="READ"):
    """Read the next bytes of a file."""

    handle: U8
    length: U16

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The bytes, always as many as requested: past the file's end they are zeros and the status says so.

        Over USB the data stop at 58 bytes although ``length`` repeats the request.
        """

        handle: U8
        length: U16
        data: Rest


@final
@dataclass(frozen=True)
class WriteFile(SystemCommand["WriteFile.Reply"], opcode=0x83, name="WRITE"):
    """Write the next bytes of a file: all that the telegram holds."""

    handle: U8
    data: Rest

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """How many bytes were written; fewer than sent when the declared size is reached."""

        handle: U8
        written: U16


@final
@dataclass(frozen=True)
class CloseFile(SystemCommand[FileHandle], opcode=0x84, name="CLOSE"):
    """Close a file; a program or system file of which bytes are missing then vanishes."""

    Reply = FileHandle
    handle: U8


@final
@dataclass(frozen=True)
class DeleteFile(SystemCommand["DeleteFile.Reply"], opcode=0x85, name="DELETE"):
    """Delete a file that is not open."""

    name: Name20

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The name, whether or not it could be deleted."""

        name: Name20


@final
@dataclass(frozen=True)
class FindFirst(SystemCommand[FileFound], opcode=0x86, name="FIND_FIRST"):
    """Start a search for files, newest first: ``*.*``, ``name.*``, ``*.ext`` or a name."""

    Reply = FileFound
    pattern: Name20


@final
@dataclass(frozen=True)
class FindNext(SystemCommand[FileFound], opcode=0x87, name="FIND_NEXT"):
    """Go on with a search; the handle stays open, found or not."""

    Reply = FileFound
    handle: U8


@final
@dataclass(frozen=True)
class OpenWriteLinear(SystemCommand[FileHandle], opcode=0x89, name="OPEN_WRITE_LINEAR"):
    """Create a file of a fixed size in one piece of flash memory."""

    Reply = FileHandle
    name: Name20
    size: U32


@final
@dataclass(frozen=True)
class OpenWriteData(SystemCommand[FileHandle], opcode=0x8B, name="OPEN_WRITE_DATA"):
    """Create a data file, which may be closed before it is full and appended to later."""

    Reply = FileHandle
    name: Name20
    size: U32


@final
@dataclass(frozen=True)
class OpenAppendData(SystemCommand[FileOpened], opcode=0x8C, name="OPEN_APPEND_DATA"):
    """Open a data file for appending; the size is what is still free in it."""

    Reply = FileOpened
    name: Name20


@final
@dataclass(frozen=True)
class CropDataFile(SystemCommand[FileHandle], opcode=0x8D, name="CROP_DATA_FILE"):
    """Close a data file and give back what is free in it."""

    Reply = FileHandle
    handle: U8


@final
@dataclass(frozen=True)
class DeleteUserFlash(SystemCommand[NoData], opcode=0xA0, name="DELETE_USER_FLASH"):
    """Delete all files and close all handles; takes seconds."""
