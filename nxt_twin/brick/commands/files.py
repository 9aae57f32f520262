"""Files on the brick: each command as it is; `FileTransfer` reads and writes whole ones."""

from __future__ import annotations

from typing import Final, NamedTuple, final

from firmware_protocol import (
    CloseFile,
    CropDataFile,
    DeleteFile,
    DeleteUserFlash,
    FileFound,
    FileHandle,
    FindFirst,
    FindNext,
    IllegalFileNameError,
    OpenAppendData,
    OpenRead,
    OpenWrite,
    OpenWriteData,
    OpenWriteLinear,
    ReadFile,
    WriteFile,
    check_file_name,
)
from nxt_twin.brick.errors import RequestError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped

_DELETE_ALL_S: Final = 30.0
"""How long the brick may take to wipe its flash memory."""


class OpenedFile(NamedTuple):
    """A file that is open.

    Attributes:
        handle: what the further commands name it by.
        size: the bytes there are to read, or that may be written.
    """

    handle: int
    size: int


class FoundFile(NamedTuple):
    """A file that a search found.

    Attributes:
        handle: the search's handle.
        name: the file's name.
        size: the bytes that it occupies; a data file may hold fewer.
    """

    handle: int
    name: str
    size: int


@final
class Files:
    """The file commands of a brick; every method raises what `Exchange.put` does.

    The brick has 16 handles, and closes them by itself only when a USB cable is pulled.
    """

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    def open_read(self, name: str) -> Stamped[OpenedFile]:
        """Open a file for reading; an empty one counts as missing."""
        reply = self._exchange.ask(OpenRead(_checked(name)))
        return reply.having(OpenedFile(reply.value.handle, reply.value.size))

    def open_write(self, name: str, size: int) -> Stamped[OpenedFile]:
        """Create a file of a fixed size; programs and system files go into one piece of memory."""
        return _opened(self._exchange.ask(OpenWrite(_checked(name), size)), size)

    def open_write_linear(self, name: str, size: int) -> Stamped[OpenedFile]:
        """Create a file of a fixed size in one piece of memory."""
        return _opened(self._exchange.ask(OpenWriteLinear(_checked(name), size)), size)

    def open_write_data(self, name: str, size: int) -> Stamped[OpenedFile]:
        """Create a data file, which may be closed before it is full."""
        return _opened(self._exchange.ask(OpenWriteData(_checked(name), size)), size)

    def open_append_data(self, name: str) -> Stamped[OpenedFile]:
        """Open a data file for appending; the size is what is still free in it."""
        reply = self._exchange.ask(OpenAppendData(_checked(name)))
        return reply.having(OpenedFile(reply.value.handle, reply.value.size))

    def read(self, handle: int, length: int) -> Stamped[bytes]:
        """The next bytes, as many as were asked for; status END_OF_FILE where there are fewer.

        The telegram limits the length: at most 58 over USB, 122 over Bluetooth.
        """
        reply = self._exchange.ask(ReadFile(handle, length))
        return reply.having(reply.value.data)

    def write(self, handle: int, data: bytes) -> Stamped[int]:
        """Write the next bytes, and tell how many the brick took."""
        reply = self._exchange.ask(WriteFile(handle, data))
        return reply.having(reply.value.written)

    def close(self, handle: int) -> Stamped[None]:
        """Close a file; a program or system file of which bytes are missing vanishes without an error."""
        return self._exchange.ask(CloseFile(handle)).having(None)

    def crop_data(self, handle: int) -> Stamped[None]:
        """Close a data file and give back what is free in it."""
        return self._exchange.ask(CropDataFile(handle)).having(None)

    def delete(self, name: str) -> Stamped[None]:
        """Delete a file."""
        return self._exchange.ask(DeleteFile(_checked(name))).having(None)

    def delete_all(self) -> Stamped[None]:
        """Delete all files of the user (DELETE_USER_FLASH); takes seconds."""
        return self._exchange.ask(DeleteUserFlash(), timeout_s=_DELETE_ALL_S).having(None)

    def find_first(self, pattern: str) -> Stamped[FoundFile]:
        """Start a search: ``*.*``, ``name.*``, ``*.ext`` or a name; status FILE_NOT_FOUND where none is."""
        return _found(self._exchange.ask(FindFirst(pattern)))

    def find_next(self, handle: int) -> Stamped[FoundFile]:
        """Go on with a search, which stays open, found or not."""
        return _found(self._exchange.ask(FindNext(handle)))


def _opened(reply: Stamped[FileHandle], size: int) -> Stamped[OpenedFile]:
    return reply.having(OpenedFile(reply.value.handle, size))


def _found(reply: Stamped[FileFound]) -> Stamped[FoundFile]:
    return reply.having(FoundFile(reply.value.handle, reply.value.name, reply.value.size))


def _checked(name: str) -> str:
    try:
        return check_file_name(name)
    except IllegalFileNameError as error:
        raise RequestError(str(error), mend="at most 15 characters, a point and 3 more") from error
