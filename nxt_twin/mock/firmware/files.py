"""System commands for files. Their replies name a handle whatever the status.

Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, TypeVar, final

import firmware_protocol as fp
from firmware_protocol import ReplyData, Status
from nxt_twin.mock.firmware.channel import Channel
from nxt_twin.mock.firmware.flash import StoredFile
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal
from nxt_twin.mock.firmware.refusal import RefusedReply

_REPLY_DATA_OFFSET: Final = 6
"""Where the data start in a READ reply."""

Found = TypeVar("Found")


@final
class FileCommands:
    """Executes file commands on the loader."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def open_read(self, request: fp.OpenRead, channel: Channel) -> ReplyData:
        """OPEN_READ."""
        handle, size = self._open(channel, lambda: self._loader.open_read(request.name), _opened)
        return fp.FileOpened(handle, size)

    def open_write(self, request: fp.OpenWrite, channel: Channel) -> ReplyData:
        """OPEN_WRITE, which chooses the layout by the name."""
        linear = fp.is_linear_name(request.name)
        return self._create(channel, request.name, request.size, linear=linear)

    def open_write_linear(self, request: fp.OpenWriteLinear, channel: Channel) -> ReplyData:
        """OPEN_WRITE_LINEAR."""
        return self._create(channel, request.name, request.size, linear=True)

    def open_write_data(self, request: fp.OpenWriteData, channel: Channel) -> ReplyData:
        """OPEN_WRITE_DATA."""
        if fp.is_linear_name(request.name):
            raise RefusedReply(Status.ILLEGAL_FILE_NAME, fp.FileHandle(0))
        return self._create(channel, request.name, request.size, appendable=True)

    def open_append(self, request: fp.OpenAppendData, channel: Channel) -> ReplyData:
        """OPEN_APPEND_DATA."""
        handle, room = self._open(channel, lambda: self._loader.open_append(request.name), _opened)
        return fp.FileOpened(handle, room)

    def read(self, request: fp.ReadFile, channel: Channel) -> ReplyData:
        """READ of what fits: the length is repeated as requested, and the data are filled up with zeros."""
        fitting = min(request.length, channel.sizes.read)
        try:
            data, status = self._loader.read(request.handle, fitting)
        except LoaderRefusal as refusal:
            stale = bytes(channel.stale[_REPLY_DATA_OFFSET : _REPLY_DATA_OFFSET + fitting])
            reply = fp.ReadFile.Reply(request.handle, request.length, stale.ljust(fitting, b"\0"))
            raise RefusedReply(refusal.status, reply) from None
        reply = fp.ReadFile.Reply(request.handle, request.length, data.ljust(fitting, b"\0"))
        if status != Status.OK:
            raise RefusedReply(status, reply)
        return reply

    def close(self, request: fp.CloseFile, channel: Channel) -> ReplyData:
        """CLOSE."""
        channel.handles.discard(request.handle)
        return _closed(self._loader.close(request.handle), request.handle)

    def crop(self, request: fp.CropDataFile, channel: Channel) -> ReplyData:
        """CROP_DATA_FILE."""
        del channel
        return _closed(self._loader.crop(request.handle), request.handle)

    def delete(self, request: fp.DeleteFile, channel: Channel) -> ReplyData:
        """DELETE."""
        del channel
        reply = fp.DeleteFile.Reply(request.name)
        try:
            self._loader.delete(request.name)
        except LoaderRefusal as refusal:
            raise RefusedReply(refusal.status, reply) from None
        return reply

    def find_first(self, request: fp.FindFirst, channel: Channel) -> ReplyData:
        """FIND_FIRST."""
        handle, file = self._open(channel, lambda: self._loader.find_first(request.pattern), _found_none)
        return _found(handle, file)

    def find_next(self, request: fp.FindNext, channel: Channel) -> ReplyData:
        """FIND_NEXT."""
        del channel
        try:
            return _found(request.handle, self._loader.find_next(request.handle))
        except LoaderRefusal as refusal:
            raise RefusedReply(refusal.status, _found_none(refusal.handle)) from None

    def _create(
        self, channel: Channel, name: str, size: int, *, linear: bool = False, appendable: bool = False
    ) -> ReplyData:
        def create() -> tuple[int, None]:
            return self._loader.open_write(name, size, linear=linear, appendable=appendable), None

        return fp.FileHandle(self._open(channel, create, fp.FileHandle)[0])

    def _open(
        self, channel: Channel, open_: Callable[[], tuple[int, Found]], refused: Callable[[int], ReplyData]
    ) -> tuple[int, Found]:
        try:
            handle, found = open_()
        except LoaderRefusal as refusal:
            raise RefusedReply(refusal.status, refused(refusal.handle)) from None
        channel.handles.add(handle)
        return handle, found


def _opened(handle: int) -> ReplyData:
    return fp.FileOpened(handle, 0)


def _closed(status: Status, handle: int) -> ReplyData:
    if status != Status.OK:
        raise RefusedReply(status, fp.FileHandle(handle))
    return fp.FileHandle(handle)


def _found(handle: int, file: StoredFile) -> ReplyData:
    return fp.FileFound(handle, file.name, file.size)


def _found_none(handle: int) -> ReplyData:
    return fp.FileFound(handle, "", 0)
