"""The loader: files by handle, searches, and the table of files.

Source: LEGO NXT firmware 1.29, c_loader.c and d_loader.c.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum
from typing import Final, final

from firmware_protocol import (
    LoaderMap,
    ModuleId,
    Status,
    decode_io_map,
    encode_io_map,
    fold_case,
    limits,
    pattern_matches,
)
from firmware_protocol.names import NAME_LENGTH_MAX
from nxt_twin.mock.firmware.flash import SectorTable, StoredFile, free_bytes, sectors_needed
from nxt_twin.mock.firmware.integers import u16
from nxt_twin.mock.firmware.module import Module

_EXTENSION_SIZE: Final = 4
_BEFORE_FIRST: Final = 0xFFFF
"""Indices are 16-bit words: from here the next one is 0."""


class LoaderRefusal(Exception):  # noqa: N818 - a refusal is what it is
    """The loader says no.

    Args:
        status: why.
        handle: the handle that the reply names beside it.
    """

    def __init__(self, status: Status, handle: int = 0) -> None:
        self.status = status
        self.handle = handle
        super().__init__(f"{status.text} (handle {handle})")


class Use(Enum):
    """The use of a handle."""

    FREE = "free"
    READING = "reading"
    SEARCHING = "searching"
    WRITING = "writing"


@final
class Handle:
    """One of the sixteen handles; what a closed one knew stays until it is used again.

    A handle that never was used stands on the first file, and its pattern of None finds all.
    """

    __slots__ = ("buffered", "failed", "file", "index", "pattern", "position", "remaining", "use")

    def __init__(self) -> None:
        self.use = Use.FREE
        self.pattern: str | None = None
        self.index = 0
        self.file: StoredFile | None = None
        self.position = 0
        self.remaining = 0
        self.buffered = False
        self.failed = False


@final
class Loader(Module):
    """Files in flash, newest first.

    Args:
        files: what is in flash already.
    """

    module_id = ModuleId.LOADER
    name = "Loader.mod"

    def __init__(self, files: Iterable[StoredFile] = ()) -> None:
        self.files = list(files)
        self.handles = tuple(Handle() for _ in range(limits.FILE_HANDLE_COUNT))
        self._sectors = SectorTable()
        self._free = 0
        self._function_pointer = 0
        self._recount()
        self.free_flash = self._free
        """Free bytes as the IO map publishes them, which is not always up to date."""

    def open_read(self, name: str) -> tuple[int, int]:
        """A handle for reading, and the number of bytes to read.

        An empty file is refused as missing, and then handle 0 is closed in place of the one it got.
        """
        number, file = self._find_by_name(name)
        if file.size == 0:
            self.close(0)
            raise LoaderRefusal(Status.FILE_NOT_FOUND)
        handle = self.handles[number]
        handle.file = file
        handle.position, handle.remaining = 0, file.told
        return number, file.told

    def open_linear(self, name: str) -> tuple[int, StoredFile]:
        """A handle for a file that lies in one piece, as a program's does while it runs."""
        number, file = self._find_by_name(name)
        if not file.linear:
            self.close(number)
            raise LoaderRefusal(Status.NOT_A_LINEAR_FILE, number)
        return number, file

    def open_write(self, name: str, size: int, *, linear: bool = False, appendable: bool = False) -> int:
        """A handle for writing a new file of `size` bytes."""
        number = self._take_handle()
        try:
            self._check_new(number, name, size)
            sectors = self._sectors.take(sectors_needed(size), linear=linear)
            if sectors is None:
                status = Status.NO_LINEAR_SPACE if linear else Status.UNDEFINED_ERROR
                raise LoaderRefusal(status, number)
        except LoaderRefusal:
            self.close(number)
            raise
        handle = self.handles[number]
        handle.file = StoredFile(name, size, linear, appendable, sectors)
        handle.position, handle.remaining, handle.failed = 0, size, False
        handle.use = Use.WRITING
        if appendable:
            self._insert(handle.file)
            handle.index = 0
        self._free = free_bytes(self._sectors.free)
        self.free_flash = self._free
        return number

    def _check_new(self, number: int, name: str, size: int) -> None:
        handle = self.handles[number]
        if len(name) > NAME_LENGTH_MAX:
            raise LoaderRefusal(Status.ILLEGAL_FILE_NAME, number)
        self._aim(handle, name)
        if self._search(handle) is not None or self._is_downloading(name):
            raise LoaderRefusal(Status.FILE_EXISTS, number)
        unlisted = sum(h.use is Use.WRITING and not _appendable(h) for h in self.handles)
        if len(self.files) + unlisted >= limits.FILE_COUNT:
            raise LoaderRefusal(Status.NO_MORE_FILES, number)
        self._take_buffer(number)
        if size > self._free:
            raise LoaderRefusal(Status.NO_SPACE, number)

    def open_append(self, name: str) -> tuple[int, int]:
        """A handle for appending to a data file, and how many bytes still fit."""
        number, file = self._find_by_name(name)
        try:
            if self._is_downloading(name):
                raise LoaderRefusal(Status.FILE_IS_BUSY, number)
            if not file.appendable:
                raise LoaderRefusal(Status.APPEND_NOT_POSSIBLE, number)
            room = file.size - file.told
            if room <= 0:
                raise LoaderRefusal(Status.FILE_IS_FULL, number)
            self._take_buffer(number)
        except LoaderRefusal:
            self.close(number)
            raise
        handle = self.handles[number]
        handle.file, handle.use = file, Use.WRITING
        handle.position, handle.remaining, handle.failed = file.told, room, False
        return number, room

    def read(self, number: int, length: int) -> tuple[bytes, Status]:
        """The next bytes of a file; fewer than asked for, with that status, at its end."""
        handle = self._handle_for(number, Use.READING)
        if handle.file is None:
            return b"", Status.END_OF_FILE
        given = min(length, handle.remaining)
        data = bytes(handle.file.data[handle.position : handle.position + given])
        handle.position += len(data)
        handle.remaining -= len(data)
        return data, Status.OK if len(data) == length else Status.END_OF_FILE

    def rest(self, number: int) -> bytes:
        """The unread bytes of the file; they stay unread."""
        handle = self._handle_for(number, Use.READING)
        return b"" if handle.file is None else bytes(handle.file.data[handle.position :])

    def write(self, number: int, data: bytes) -> tuple[int, Status]:
        """Append to a file that is being written: how many bytes fitted, and whether all ever did."""
        handle = self._handle_for(number, Use.WRITING)
        if len(data) > handle.remaining:
            data = data[: handle.remaining]
            handle.failed = True
        if handle.file is not None:
            handle.file.data[handle.position : handle.position + len(data)] = data
        handle.position += len(data)
        handle.remaining -= len(data)
        return len(data), Status.END_OF_FILE_EXPECTED if handle.failed else Status.OK

    def close(self, number: int) -> Status:
        """Close a handle; a file that is not complete vanishes, unless it is a data file. Never refused."""
        if number >= len(self.handles):
            return Status.OK
        handle = self.handles[number]
        if handle.use is Use.FREE:
            return Status.HANDLE_ALREADY_CLOSED
        if handle.use is Use.WRITING and handle.file is not None:
            self._complete(handle, handle.file)
        handle.buffered = False
        handle.use = Use.FREE
        return Status.OK

    def _complete(self, handle: Handle, file: StoredFile) -> None:
        if file.appendable:
            file.told = file.size - handle.remaining
        elif handle.failed or handle.remaining:
            self._recount()
        else:
            file.told = file.size
            self._insert(file)

    def crop(self, number: int) -> Status:
        """Close a handle and give back what is free in the data file that it stands on."""
        index = self.handles[number].index & 0xFF if number < len(self.handles) else len(self.files)
        status = self.close(number)
        if status == Status.OK and index < len(self.files):
            file = self.files[index]
            if file.told < file.size:
                file.size = file.told
                file.sectors = file.sectors[: sectors_needed(file.size)]
                self._recount()
        self.free_flash = self._free
        return status

    def delete(self, name: str) -> None:
        """Delete a file on which no other handle stands that reads or writes.

        A handle stands at a place in the list. A handle that writes a system file, which is not listed yet, stands on
        other files once those are listed.
        """
        try:
            number, file = self._find_by_name(name)
            self.close(number)
            gone = self.files.index(file)
            if any(
                handle.index == gone and handle.use in (Use.READING, Use.WRITING) for handle in self.handles
            ):
                raise LoaderRefusal(Status.FILE_IS_BUSY, number)
            del self.files[gone]
            self._recount()
            for handle in self.handles:
                if handle.use is not Use.FREE and handle.index > gone:
                    handle.index -= 1
        finally:
            self.free_flash = self._free

    def delete_all(self) -> None:
        """Delete all files and close all handles."""
        for number in range(len(self.handles)):
            self.close(number)
        self.files.clear()
        self._recount()
        self.free_flash = self._free

    def find_first(self, pattern: str) -> tuple[int, StoredFile]:
        """A search handle and the first file that the pattern finds."""
        number = self._take_handle()
        handle = self.handles[number]
        file = None
        if len(pattern) <= NAME_LENGTH_MAX:
            self._aim(handle, pattern)
            handle.use = Use.SEARCHING
            file = self._search(handle)
        if file is None:
            self.close(number)
            too_long = len(pattern) > NAME_LENGTH_MAX
            raise LoaderRefusal(Status.ILLEGAL_FILE_NAME if too_long else Status.FILE_NOT_FOUND, number)
        return number, file

    def find_next(self, number: int) -> StoredFile:
        """The next file of a search; the handle stays open, found or not, and is not checked."""
        file = self._search(self.handles[number]) if number < len(self.handles) else None
        if file is None:
            raise LoaderRefusal(Status.FILE_NOT_FOUND, number)
        return file

    def find(self, name: str) -> StoredFile | None:
        """The file of that name, found through a handle that is given back at once."""
        try:
            number, file = self.find_first(name)
        except LoaderRefusal:
            return None
        self.close(number)
        return file

    def _take_handle(self) -> int:
        for number, handle in enumerate(self.handles):
            if handle.use is Use.FREE:
                handle.use = Use.READING
                handle.file = None
                return number
        raise LoaderRefusal(Status.NO_MORE_HANDLES)

    def _find_by_name(self, name: str) -> tuple[int, StoredFile]:
        number = self._take_handle()
        handle = self.handles[number]
        file = None
        if len(name) <= NAME_LENGTH_MAX:
            self._aim(handle, name)
            file = self._search(handle)
        if file is None:
            self.close(number)
            too_long = len(name) > NAME_LENGTH_MAX
            raise LoaderRefusal(Status.ILLEGAL_FILE_NAME if too_long else Status.FILE_NOT_FOUND, number)
        handle.file = file
        return number, file

    def _aim(self, handle: Handle, pattern: str) -> None:
        handle.pattern = pattern
        handle.index = _BEFORE_FIRST

    def _search(self, handle: Handle) -> StoredFile | None:
        for index in range(u16(handle.index + 1), len(self.files)):
            if handle.pattern is None or pattern_matches(handle.pattern, self.files[index].name):
                handle.index = index
                return self.files[index]
        return None

    def _is_downloading(self, name: str) -> bool:
        wanted = fold_case(name)
        return any(h.use is Use.WRITING and _kept(h.pattern or "") == wanted for h in self.handles)

    def _take_buffer(self, number: int) -> None:
        if sum(handle.buffered for handle in self.handles) >= limits.WRITE_BUFFER_COUNT:
            raise LoaderRefusal(Status.NO_WRITE_BUFFERS, number)
        self.handles[number].buffered = True

    def _handle_for(self, number: int, use: Use) -> Handle:
        if number >= len(self.handles) or self.handles[number].use is not use:
            raise LoaderRefusal(Status.ILLEGAL_HANDLE, number)
        return self.handles[number]

    def _insert(self, file: StoredFile) -> None:
        self.files.insert(0, file)
        for handle in self.handles:
            if handle.use is not Use.FREE:
                handle.index = u16(handle.index + 1)

    def _recount(self) -> None:
        self._sectors.rebuild(self.files)
        self._free = free_bytes(self._sectors.free)

    def export(self) -> bytes:
        """The IO map."""
        return encode_io_map(LoaderMap(self._function_pointer, self.free_flash))

    def adopt(self, data: bytes) -> None:
        """Take over the IO map."""
        given = decode_io_map(LoaderMap, data)
        self._function_pointer = given.function_pointer
        self.free_flash = given.free_user_flash


def _kept(pattern: str) -> str:
    """The part of a pattern that a handle keeps; it is incomplete if the pattern has a wildcard."""
    folded = fold_case(pattern)
    if "*.*" in folded:
        return pattern
    if ".*" in folded:
        return folded[:-1]
    return folded[1 : 1 + _EXTENSION_SIZE] if "*." in folded else folded


def _appendable(handle: Handle) -> bool:
    return handle.file is not None and handle.file.appendable
