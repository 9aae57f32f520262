"""Telegrams over a stream of bytes, each behind its length, as on Bluetooth."""

from __future__ import annotations

from collections import deque
from typing import Final, Protocol, final

from firmware_protocol import FrameSplitter, FrameTooLongError, frame
from firmware_protocol.bluetooth import LENGTH_PREFIX_SIZE, RECEIVE_BUFFER_SIZE
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import GarbageError, HalfTelegramError, LinkTimeoutError

_QUIET_S: Final = 0.05
"""A stream that was silent for so long is between two telegrams."""
_DRAIN_READS_MAX: Final = 256
_PREFIXES: Final = tuple(
    size.to_bytes(LENGTH_PREFIX_SIZE, "little") for size in range(RECEIVE_BUFFER_SIZE + 1)
)
"""What stands before a telegram, by its length."""


class ByteStream(Protocol):
    """An open stream that keeps no boundaries."""

    def write(self, data: bytes) -> None:
        """Hand all bytes over, at once.

        Raises:
            LinkLostError: the other end is gone.
            LinkTimeoutError: the other end takes nothing any more.
        """
        ...

    def read(self, timeout_s: float) -> bytes:
        """The bytes that have arrived, once there are any; empty if none came in time.

        Raises:
            LinkLostError: the other end is gone.
        """
        ...

    def close(self) -> None:
        """Let go of the other end; closing again does nothing."""
        ...


@final
class StreamLink:
    """A link over a stream of bytes.

    A length may make no sense, or the rest of a telegram may not come. The link then drops all bytes up to the next
    silence, and is in step again for the next request.

    Args:
        stream: the open stream, which the link takes over.
        clock: measures how long to wait for the rest of a telegram.
        name: what a person calls this link.
    """

    def __init__(self, stream: ByteStream, clock: Clock, name: str) -> None:
        self._stream = stream
        self._clock = clock
        self._name = name
        self._write, self._read = stream.write, stream.read
        self._splitter = FrameSplitter()
        self._ready: deque[bytes] = deque()
        self._out_of_step = False

    def send(self, telegram: bytes) -> None:
        """Hand one telegram over, behind its length, in a single write; errors as with `Link`."""
        if self._out_of_step:
            self._drain()
        size = len(telegram)
        self._write(_PREFIXES[size] + telegram if size < len(_PREFIXES) else frame(telegram))

    def receive(self, timeout_s: float) -> bytes:
        """Wait for one telegram; errors as with `Link`."""
        if not self._ready:
            data = self._read(timeout_s)
            # Exactly one telegram behind its length, as nearly always.
            size = len(data) - LENGTH_PREFIX_SIZE
            if 0 < size < len(_PREFIXES) and data.startswith(_PREFIXES[size]) and not self._splitter.pending:
                return data[LENGTH_PREFIX_SIZE:]
            self._put_together(data, timeout_s)
        return self._ready.popleft()

    def close(self) -> None:
        """Close the stream."""
        self._stream.close()

    def describe(self) -> str:
        """The link's name for a person."""
        return self._name

    def _put_together(self, data: bytes, timeout_s: float) -> None:
        give_up_s = self._clock.now_s() + timeout_s
        while not self._split(data):
            left_s = give_up_s - self._clock.now_s()
            if not data or left_s <= 0:
                self._give_up(timeout_s)
            data = self._stream.read(left_s)

    def _split(self, data: bytes) -> bool:
        """Whether the bytes complete a telegram."""
        try:
            self._ready.extend(self._splitter.feed(data))
        except FrameTooLongError as error:
            self._drain()
            raise GarbageError(str(error), where=self._name) from error
        return bool(self._ready)

    def _give_up(self, timeout_s: float) -> None:
        if not self._splitter.pending:
            raise LinkTimeoutError(f"nothing came within {timeout_s:g} s", where=self._name)
        half = self._splitter.reset()
        self._out_of_step = True
        raise HalfTelegramError(
            f"only half a telegram came within {timeout_s:g} s: {half.hex(' ')}", where=self._name
        )

    def _drain(self) -> None:
        for _ in range(_DRAIN_READS_MAX):
            if not self._stream.read(_QUIET_S):
                break
        self._splitter.reset()
        self._out_of_step = False
