"""Frames: pieces of a growing file, each with its number, its length and checksums, so that damage is placed.

A frame is `NXTr`, four little-endian u32 and the payload. The u32 are its number, the payload's length, the payload's
CRC-32, and the CRC-32 of the sixteen bytes so far. A reader trusts a length only if its checksum is right, and finds
the next whole frame after damage.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, final

_MARK: Final = b"NXTr"
_HEAD: Final = struct.Struct("<4s4I")
_CHECKED: Final = _HEAD.size - 4


@final
@dataclass(frozen=True)
class Frame:
    """A whole frame.

    Attributes:
        number: as written.
        payload: its bytes.
    """

    number: int
    payload: bytes


@final
@dataclass(frozen=True)
class Damage:
    """A stretch that holds no whole frame although it is not the end of a file that was cut off.

    Attributes:
        offset: of its first byte in the file.
        size: in bytes.
    """

    offset: int
    size: int


def framed(number: int, payload: bytes) -> bytes:
    """A frame's bytes."""
    head = struct.pack("<4s3I", _MARK, number, len(payload), zlib.crc32(payload))
    return head + struct.pack("<I", zlib.crc32(head)) + payload


def frames(data: bytes) -> Iterator[Frame | Damage]:
    """All frames of a file in order, and what lies damaged between them.

    Where a file was cut off, its last frame is not whole, or nothing but zeros follows; that is the end, and no damage.
    """
    at = 0
    while at < len(data):
        found = _frame_at(data, at)
        if found is not None:
            at += _HEAD.size + len(found.payload)
            yield found
            continue
        if _is_cut_off(data, at):
            return
        resumed = _next_frame(data, at + 1)
        yield Damage(at, resumed - at)
        at = resumed


def _frame_at(data: bytes, at: int) -> Frame | None:
    length = _length_at(data, at)
    if length is None:
        return None
    payload = data[at + _HEAD.size : at + _HEAD.size + length]
    _, number, _, checksum, _ = _HEAD.unpack_from(data, at)
    whole = len(payload) == length and zlib.crc32(payload) == checksum
    return Frame(number, payload) if whole else None


def _length_at(data: bytes, at: int) -> int | None:
    """The payload's length, where a frame's head is right."""
    head = data[at : at + _HEAD.size]
    if len(head) < _HEAD.size or not head.startswith(_MARK):
        return None
    _, _, length, _, checksum = _HEAD.unpack(head)
    return int(length) if zlib.crc32(head[:_CHECKED]) == checksum else None


def _is_cut_off(data: bytes, at: int) -> bool:
    left = len(data) - at
    length = _length_at(data, at)
    if length is not None:
        return left < _HEAD.size + length and _next_frame(data, at + 1) == len(data)
    begun = data[at : at + _HEAD.size]
    is_head = left < _HEAD.size and begun.startswith(_MARK[:left])
    return is_head or not data[at:].strip(b"\0")


def _next_frame(data: bytes, at: int) -> int:
    """Where the next frame with a right head begins; the file's end if there is none."""
    while (at := data.find(_MARK, at)) >= 0:
        if _length_at(data, at) is not None:
            return at
        at += 1
    return len(data)
