"""Frames on Bluetooth: a two-byte little-endian length, not counting itself, before each telegram.

Source: LEGO NXT firmware 1.29, d_bt.r (BTReceivedData).
"""

from __future__ import annotations

from typing import final

from firmware_protocol.bluetooth import FRAME_SIZE_MAX, LENGTH_PREFIX_SIZE, RECEIVE_BUFFER_SIZE
from firmware_protocol.errors import FrameTooLongError


def frame(telegram: bytes) -> bytes:
    """The telegram behind its length.

    Raises:
        FrameTooLongError: it has more than 65535 bytes.
    """
    if len(telegram) > FRAME_SIZE_MAX:
        raise FrameTooLongError(f"a frame holds {FRAME_SIZE_MAX} bytes, the telegram has {len(telegram)}")
    return len(telegram).to_bytes(LENGTH_PREFIX_SIZE, "little") + telegram


@final
class FrameSplitter:
    """Cuts a stream of bytes, in whatever pieces it comes, into telegrams.

    Frames of length 0 are swallowed, as the firmware does.

    Args:
        longest: the longest telegram to accept. A longer length means that the stream is out of step, not
            a long telegram; the default is the firmware's buffer. A brick itself takes any length (65535).
    """

    def __init__(self, longest: int = RECEIVE_BUFFER_SIZE) -> None:
        self._longest = longest
        self._pending = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Take the next bytes of the stream and give the telegrams that they complete, in order.

        The rest waits for the next call. Telegrams that precede an over-long length are given first; the
        error comes with the next call, and with every further one until `reset`.

        Raises:
            FrameTooLongError: the next length exceeds the longest telegram.
        """
        self._pending += data
        telegrams: list[bytes] = []
        while len(self._pending) >= LENGTH_PREFIX_SIZE:
            length = int.from_bytes(self._pending[:LENGTH_PREFIX_SIZE], "little")
            if length > self._longest:
                if telegrams:
                    break
                raise FrameTooLongError(
                    f"the next frame announces {length} bytes, more than {self._longest}: out of step, reset"
                )
            end = LENGTH_PREFIX_SIZE + length
            if len(self._pending) < end:
                break
            if length:
                telegrams.append(bytes(self._pending[LENGTH_PREFIX_SIZE:end]))
            del self._pending[:end]
        return telegrams

    def reset(self) -> bytes:
        """Forget all bytes that wait, and give them; the next byte fed is to be the start of a frame."""
        dropped = bytes(self._pending)
        self._pending.clear()
        return dropped

    @property
    def pending(self) -> int:
        """How many bytes wait for the rest of their frame."""
        return len(self._pending)
