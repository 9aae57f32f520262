"""READ over Bluetooth of more than fits a buffer: the radio's own job, piece by piece from the file.

Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd (READ) and cCommUpdateBt (UPD_EXTREAD).
"""

from __future__ import annotations

import math
from typing import Final, final

from firmware_protocol import ReadFile, Status, TelegramType
from firmware_protocol.bluetooth import FRAME_SIZE_MAX, LENGTH_PREFIX_SIZE, RECEIVE_BUFFER_SIZE
from nxt_twin.mock.firmware.channel import Channel
from nxt_twin.mock.firmware.loader import Loader, LoaderRefusal
from nxt_twin.mock.firmware.radio import RadioModule

_HEADER_SIZE: Final = 6
_FIRST_SIZE: Final = RECEIVE_BUFFER_SIZE - LENGTH_PREFIX_SIZE - _HEADER_SIZE
_BYTES_PER_MS: Final = 46.08
"""460800 baud between processor and radio."""


@final
class LongRead:
    """One long read at a time; asked for while the radio is busy, it is forgotten.

    It answers whether or not a reply was asked for. The length prefix and the status come with the first piece;
    a file that ends sooner sends fewer bytes than were promised. A handle that cannot be read sends what the buffer
    holds.

    Args:
        loader: the files.
        channel: Bluetooth.
        radio: busy while it reads.
    """

    def __init__(self, loader: Loader, channel: Channel, radio: RadioModule) -> None:
        self._loader = loader
        self._channel = channel
        self._radio = radio
        self._buffer = bytearray(RECEIVE_BUFFER_SIZE)
        self._handle = 0
        self._remaining = 0
        self._first = False
        self._wait_ms = 0

    def start(self, handle: int, length: int) -> None:
        """Take the request, if the radio has time."""
        if self._radio.busy:
            return
        self._radio.reading = True
        self._handle, self._remaining, self._first = handle, length, True

    def cancel(self) -> None:
        """The connection is gone."""
        self._radio.reading = False

    def tick(self) -> None:
        """One pass: the next piece, once the one before is out."""
        if not self._radio.reading:
            return
        if self._first:
            self._send_first()
            return
        self._wait_ms -= 1
        if self._wait_ms > 0:
            return
        size = min(self._remaining, RECEIVE_BUFFER_SIZE)
        self._remaining -= size
        self._radio.reading = self._remaining > 0
        given, _ = self._read(0, size)
        self._send(bytes(self._buffer[:given]))

    def _send_first(self) -> None:
        self._first = False
        _, status = self._read(_HEADER_SIZE, _FIRST_SIZE)
        length = self._remaining.to_bytes(2, "little")
        self._buffer[:_HEADER_SIZE] = (
            bytes((TelegramType.REPLY, ReadFile.OPCODE, status, self._handle)) + length
        )
        promised = (self._remaining + _HEADER_SIZE) & FRAME_SIZE_MAX
        self._remaining -= _FIRST_SIZE
        piece = bytes(self._buffer[: _HEADER_SIZE + _FIRST_SIZE])
        self._send(promised.to_bytes(LENGTH_PREFIX_SIZE, "little") + piece)

    def _read(self, at: int, size: int) -> tuple[int, Status]:
        """Read into the buffer; how many bytes count as read."""
        try:
            data, status = self._loader.read(self._handle, size)
        except LoaderRefusal as refusal:
            return size, refusal.status
        self._buffer[at : at + len(data)] = data
        return len(data), status

    def _send(self, piece: bytes) -> None:
        self._wait_ms = math.ceil(len(piece) / _BYTES_PER_MS)
        self._channel.send(piece)
