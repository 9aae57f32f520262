"""The two ways into the firmware: USB packets, and Bluetooth's stream with its length prefixes.

Source: LEGO NXT firmware 1.29, c_comm.c, d_usb.c and d_bt.r.
"""

from __future__ import annotations

from collections import deque
from enum import Enum
from typing import Final, NamedTuple, final

from firmware_protocol import limits
from firmware_protocol.bluetooth import FRAME_SIZE_MAX, LENGTH_PREFIX_SIZE, RECEIVE_BUFFER_SIZE
from firmware_protocol.usb import PACKET_SIZE

REPLY_HEAD_SIZE: Final = 2
"""Type and opcode."""


class Transport(Enum):
    """How a host is connected."""

    USB = "usb"
    BLUETOOTH = "bluetooth"


class Sizes(NamedTuple):
    """What fits into a transport's buffers."""

    buffer: int
    read: int
    io_map: int
    poll: int


_SIZES: Final = {
    Transport.USB: Sizes(PACKET_SIZE, limits.READ_SIZE_USB, limits.IO_MAP_SIZE_USB, limits.POLL_SIZE_USB),
    Transport.BLUETOOTH: Sizes(
        RECEIVE_BUFFER_SIZE,
        limits.READ_SIZE_BLUETOOTH,
        limits.IO_MAP_SIZE_BLUETOOTH,
        limits.POLL_SIZE_BLUETOOTH,
    ),
}


class Piece(NamedTuple):
    """The bytes that the firmware takes in one pass: at most a buffer full, and how many are still to come."""

    data: bytes
    remaining: int


@final
class Channel:
    """One transport: bytes that arrived, the receive buffer, and replies to be fetched.

    Attributes:
        transport: which one.
        sizes: what fits.
        buffer: the receive buffer; what a telegram does not overwrite stays from the one before.
        stale: the reply buffer, likewise.
        handles: file handles that were opened over this channel (only USB's are ever looked at).
        extended: whether a WRITE that did not fit one piece is going on.
    """

    def __init__(self, transport: Transport) -> None:
        self.transport = transport
        self.sizes = _SIZES[transport]
        self.buffer = bytearray(self.sizes.buffer)
        self.stale = bytearray(self.sizes.buffer)
        self.handles: set[int] = set()
        self.extended: ExtendedWrite | None = None
        self._packets: deque[bytes] = deque()
        self._stream = bytearray()
        self._remaining = 0
        self._replies: deque[bytes] = deque()

    def arrive(self, data: bytes) -> None:
        """Bytes come in: over USB one packet, over Bluetooth any part of the stream."""
        if self.transport is Transport.USB:
            self._packets.append(data)
        else:
            self._stream += data

    def take(self) -> Piece | None:
        """The bytes that the firmware reads in this pass, if any."""
        if self._packets:
            data = self._packets.popleft()
            return Piece(data, 0) if data else None
        return self._take_from_stream() if self._stream else None

    def _take_from_stream(self) -> Piece | None:
        if not self._remaining:
            if len(self._stream) < LENGTH_PREFIX_SIZE:
                return None
            self._remaining = int.from_bytes(self._stream[:LENGTH_PREFIX_SIZE], "little")
            del self._stream[:LENGTH_PREFIX_SIZE]
        size = min(self._remaining, self.sizes.buffer)
        if not size or len(self._stream) < size:
            return None
        data = bytes(self._stream[:size])
        del self._stream[:size]
        self._remaining -= size
        return Piece(data, self._remaining)

    def keep(self, telegram: bytes) -> None:
        """Write a reply into the buffer, sent or not; its head is written only when it is sent."""
        kept = telegram[REPLY_HEAD_SIZE : self.sizes.buffer]
        self.stale[REPLY_HEAD_SIZE : REPLY_HEAD_SIZE + len(kept)] = kept

    def reply(self, telegram: bytes) -> None:
        """Send a reply; over USB a long one takes several packets."""
        self.keep(telegram)
        self.stale[:REPLY_HEAD_SIZE] = telegram[:REPLY_HEAD_SIZE]
        if self.transport is Transport.USB:
            for at in range(0, len(telegram), PACKET_SIZE):
                self._replies.append(telegram[at : at + PACKET_SIZE])
        else:
            length = len(telegram) & FRAME_SIZE_MAX
            self._replies.append(length.to_bytes(LENGTH_PREFIX_SIZE, "little") + telegram)

    def send(self, data: bytes) -> None:
        """Send bytes as they are: a piece of a long reply."""
        if data:
            self._replies.append(data)

    def fetch(self) -> list[bytes]:
        """All replies that wait; each is to be written in one piece."""
        if not self._replies:
            return []
        replies = list(self._replies)
        self._replies.clear()
        return replies

    def hang_up(self) -> None:
        """The host is gone: what was under way is lost, what is in the buffers stays."""
        self._packets.clear()
        self._stream.clear()
        self._replies.clear()
        self._remaining = 0
        self.extended = None


@final
class ExtendedWrite:
    """A WRITE telegram that arrives in several pieces."""

    __slots__ = ("handle", "reply_wanted", "written")

    def __init__(self, handle: int, written: int, *, reply_wanted: bool) -> None:
        self.handle = handle
        self.written = written
        self.reply_wanted = reply_wanted
