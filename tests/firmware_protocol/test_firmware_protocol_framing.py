from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol import FrameSplitter, FrameTooLongError, GetBatteryLevel, encode_request, frame

telegrams = st.lists(st.binary(max_size=128), max_size=8)


def chunked(data: bytes, cuts: list[int]) -> list[bytes]:
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    return [data[start:end] for start, end in pairwise(edges)]


def split(chunks: list[bytes], longest: int = 128) -> tuple[list[bytes], bool]:
    """All telegrams of a stream, and whether it ended in an over-long length."""
    splitter = FrameSplitter(longest)
    found: list[bytes] = []
    try:
        for chunk in [*chunks, b""]:
            found += splitter.feed(chunk)
    except FrameTooLongError:
        return found, True
    return found, False


def test_the_length_is_two_bytes_little_endian_and_does_not_count_itself():
    assert frame(encode_request(GetBatteryLevel())) == bytes.fromhex("02 00 00 0B")
    assert frame(bytes(0x0102))[:2] == b"\x02\x01"
    assert frame(b"") == b"\0\0"


def test_a_telegram_beyond_two_bytes_of_length_cannot_be_framed():
    assert len(frame(bytes(0xFFFF))) == 0x10001
    with pytest.raises(FrameTooLongError):
        frame(bytes(0x10000))


@given(telegrams, st.lists(st.integers(0, 2000), max_size=12))
def test_the_cuts_of_the_stream_do_not_matter(sent, cuts):
    stream = b"".join(frame(telegram) for telegram in sent)
    assert split(chunked(stream, cuts)) == ([telegram for telegram in sent if telegram], False)


@given(st.binary(max_size=600), st.lists(st.integers(0, 2000), max_size=12), st.integers(1, 300))
def test_any_stream_gives_the_same_telegrams_and_the_same_error_however_it_is_cut(stream, cuts, longest):
    assert split(chunked(stream, cuts), longest) == split([stream], longest)


@given(st.binary(max_size=600))
def test_nothing_of_a_good_stream_is_lost(stream):
    splitter = FrameSplitter(longest=0xFFFF)
    found = splitter.feed(stream)
    framed = sum(2 + len(telegram) for telegram in found)
    swallowed = len(stream) - framed - splitter.pending
    assert swallowed % 2 == 0
    assert stream.endswith(splitter.reset())


def test_half_a_telegram_is_kept_until_the_rest_comes():
    splitter = FrameSplitter()
    assert splitter.feed(b"\x02") == []
    assert splitter.feed(b"\x00\x00") == []
    assert splitter.pending == 3
    assert splitter.feed(b"\x0b\x03\x00") == [b"\x00\x0b"]
    assert splitter.pending == 2


def test_empty_frames_are_swallowed():
    assert FrameSplitter().feed(b"\0\0\x02\0\x00\x0b\0\0") == [b"\x00\x0b"]


def test_the_longest_telegram_is_accepted_and_one_byte_more_is_not():
    assert FrameSplitter(longest=5).feed(frame(b"12345")) == [b"12345"]
    with pytest.raises(FrameTooLongError, match="announces 6 bytes, more than 5"):
        FrameSplitter(longest=5).feed(frame(b"123456")[:2])  # refused as soon as it is announced


def test_telegrams_before_an_over_long_length_are_not_lost():
    splitter = FrameSplitter()
    assert splitter.feed(frame(b"good") + b"\xff\xff junk") == [b"good"]
    for _ in range(2):
        with pytest.raises(FrameTooLongError):
            splitter.feed(b"")


def test_after_a_reset_the_stream_starts_anew():
    splitter = FrameSplitter()
    with pytest.raises(FrameTooLongError):
        splitter.feed(b"\xff\xff junk")
    assert splitter.reset() == b"\xff\xff junk"
    assert splitter.feed(frame(b"good")) == [b"good"]
