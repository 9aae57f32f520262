"""Each kind of field by itself: its label, its width, its bytes, and what does not fit."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from enum import IntEnum

import pytest

from firmware_protocol.errors import FieldValueError
from firmware_protocol.wire import Choice, Counted, FixedBytes, Number, NumberBy, Remaining, Text, Truth


class Colour(IntEnum):
    RED = 1
    BLUE = 300


BY_KIND = NumberBy("kind", ((0, 1), (15, 4), (16, 4)))
EARLIER = {"size": 3, "kind": 15}


@pytest.mark.parametrize(
    ("wire", "label", "fixed", "width"),
    [
        (Number(1), "u8", 1, 1),
        (Number(2, signed=True), "s16", 2, 2),
        (Number(4), "u32", 4, 4),
        (Choice(Colour), "u8 Colour", 1, 1),
        (Choice(Colour, 2), "u16 Colour", 2, 2),
        (Truth(), "bool8", 1, 1),
        (Text(20), "name20", 20, 20),
        (FixedBytes(16), "bytes16", 16, 16),
        (Counted("size"), "bytes[size]", None, 3),
        (Remaining(), "rest", None, 7),
        (BY_KIND, "u8|u32 by kind", None, 4),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_kind_has_a_label_and_a_width(wire, label, fixed, width):
    assert (wire.label, wire.fixed_width, wire.width(EARLIER, 7)) == (label, fixed, width)


@pytest.mark.parametrize(
    "wire",
    [Number(1), Choice(Colour), Text(20), FixedBytes(16), Counted("size"), Truth(), Remaining(), BY_KIND],
    ids=lambda wire: wire.label,
)
def test_a_kind_never_changes_and_its_like_is_the_same_kind(wire):
    assert {wire, replace(wire)} == {wire}
    with pytest.raises(FrozenInstanceError):
        wire.size = 3


def test_a_number_whose_width_nobody_lists_takes_no_bytes():
    assert BY_KIND.width({"kind": 9}, 7) == 0
    assert (BY_KIND.pack(0, 0), BY_KIND.unpack(b"")) == (b"", 0)


@pytest.mark.parametrize(
    ("wire", "value", "spelled"),
    [
        (Number(1), 255, "ff"),
        (Number(2), 0x0102, "02 01"),
        (Number(2, signed=True), -2, "fe ff"),
        (Number(4, signed=True), -(2**31), "00 00 00 80"),
        (Choice(Colour, 2), Colour.BLUE, "2c 01"),
        (Choice(Colour), 7, "07"),
        (Truth(), True, "01"),
        (Truth(), False, "00"),
        (Text(4), "né", "6e e9 00 00"),
        (Text(2), "ab", "61 62"),
        (FixedBytes(2), b"\0\x01", "00 01"),
        (Counted("size"), b"abc", "61 62 63"),
        (Remaining(), b"", ""),
        (BY_KIND, 70_000, "70 11 01 00"),
    ],
)
def test_values_become_these_bytes_and_come_back(wire, value, spelled):
    raw = bytes.fromhex(spelled)
    assert wire.pack(value, len(raw)) == raw
    back = wire.unpack(raw)
    assert back == value
    assert type(back) is type(value)


def test_any_byte_but_zero_is_true_and_is_sent_as_one():
    assert Truth().unpack(b"\x80") is True
    assert Truth().pack(5, 1) == b"\x01"


def test_a_name_ends_at_its_first_zero_byte():
    assert Text(6).unpack(b"ab\0cd\0") == "ab"


@pytest.mark.parametrize(
    ("wire", "value", "width", "says"),
    [
        (Number(1), 256, 1, "not an unsigned integer of 1 bytes"),
        (Number(1), -1, 1, "not an unsigned"),
        (Number(1, signed=True), 128, 1, "not an signed integer of 1 bytes"),
        (Number(1), 1.0, 1, "not an unsigned"),
        (Choice(Colour), -1, 1, "not an unsigned"),
        (BY_KIND, -1, 4, "not an unsigned"),
        (Text(3), "abcd", 3, "does not fit 3 bytes"),
        (Text(3), "a\0b", 3, "does not fit"),
        (Text(3), "€", 3, "not a Latin-1 text"),
        (Text(3), 7, 3, "not a Latin-1 text"),
        (FixedBytes(2), b"abc", 2, "3 bytes were given where 2 belong"),
        (Counted("size"), b"ab", 3, "2 bytes were given where 3 belong"),
        (Remaining(), "ab", 2, "is not bytes"),
    ],
)
def test_what_does_not_fit_is_refused(wire, value, width, says):
    with pytest.raises(FieldValueError, match=says):
        wire.pack(value, width)


@pytest.mark.parametrize("given", [bytes, bytearray, memoryview])
def test_bytes_may_come_in_any_form(given):
    packed = FixedBytes(2).pack(given(b"ab"), 2)
    assert packed == b"ab"
    assert type(packed) is bytes
