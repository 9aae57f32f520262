"""Whole files to and from the brick."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final, NamedTuple, final

from firmware_protocol import Status, is_linear_name
from nxt_twin.brick.commands.files import Files, FoundFile
from nxt_twin.brick.errors import BrickError, CommandRefusedError, GarbageError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped

_READ_OVERHEAD: Final = 6
"""Bytes of a READ reply around the data: type, opcode, status, handle, length."""
_WRITE_OVERHEAD: Final = 3
"""Bytes of a WRITE request around the data: type, opcode, handle."""


class FileEntry(NamedTuple):
    """A file on the brick.

    Attributes:
        name: its name.
        size: the bytes that it occupies.
    """

    name: str
    size: int


@final
class FileTransfer:
    """Reads, writes and lists whole files; closes what it opens, and raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange, files: Files) -> None:
        self._files = files
        self._read_block = exchange.policy.telegram_size - _READ_OVERHEAD
        self._write_block = exchange.policy.telegram_size - _WRITE_OVERHEAD

    def read(self, name: str) -> Stamped[bytes]:
        """A file's bytes; of a data file, those written.

        Raises:
            GarbageError: the brick gave fewer bytes than asked for.
        """
        opened = self._files.open_read(name)
        received_s = opened.received_s
        content = bytearray()
        with self._closing(opened.value.handle):
            while len(content) < opened.value.size:
                length = min(self._read_block, opened.value.size - len(content))
                block = self._files.read(opened.value.handle, length)
                if len(block.value) != length:
                    raise GarbageError(
                        f"the brick gave {len(block.value)} bytes instead of {length}", where=name
                    )
                content += block.value
                received_s = block.received_s
        return Stamped(bytes(content), opened.sent_s, received_s)

    def write(self, name: str, content: bytes, *, replace: bool = False) -> Stamped[None]:
        """Write a file: programs and system files into one piece of memory, everything else as data.

        Its stamps are those of the command that created the file.

        Args:
            name: at most 19 characters, the extension counted.
            content: its bytes.
            replace: whether a file of that name may be there, which is then deleted first.

        Raises:
            GarbageError: the brick took fewer bytes than sent.
        """
        if replace:
            self._delete_if_there(name)
        create = self._files.open_write if is_linear_name(name) else self._files.open_write_data
        opened = create(name, len(content))
        with self._closing(opened.value.handle):
            for start in range(0, len(content), self._write_block):
                block = content[start : start + self._write_block]
                written = self._files.write(opened.value.handle, block).value
                if written != len(block):
                    raise GarbageError(f"the brick took {written} of {len(block)} bytes", where=name)
        return opened.having(None)

    def list(self, pattern: str = "*.*") -> Stamped[tuple[FileEntry, ...]]:
        """The files that fit a pattern (see `Files.find_first`), newest first."""
        try:
            first = self._files.find_first(pattern)
        except CommandRefusedError as error:
            if error.status is not Status.FILE_NOT_FOUND:
                raise
            return Stamped((), error.sent_s, error.received_s)
        entries: list[FileEntry] = []
        received_s = first.received_s
        found: Stamped[FoundFile] | None = first
        with self._closing(first.value.handle):
            while found is not None:
                entries.append(FileEntry(found.value.name, found.value.size))
                received_s = found.received_s
                found = self._next(first.value.handle)
        return Stamped(tuple(entries), first.sent_s, received_s)

    def _next(self, handle: int) -> Stamped[FoundFile] | None:
        try:
            return self._files.find_next(handle)
        except CommandRefusedError as error:
            if error.status is not Status.FILE_NOT_FOUND:
                raise
            return None

    def _delete_if_there(self, name: str) -> None:
        try:
            self._files.delete(name)
        except CommandRefusedError as error:
            if error.status is not Status.FILE_NOT_FOUND:
                raise

    @contextmanager
    def _closing(self, handle: int) -> Iterator[None]:
        try:
            yield
        except BaseException:
            with suppress(BrickError):
                self._files.close(handle)
            raise
        self._files.close(handle)
