"""Damage: what a byte, a disk, an editor or somebody who means harm makes of a valid input."""

from __future__ import annotations

from random import Random
from typing import Final

LARGEST: Final = 100_000
"""Inputs stay below this, bytes."""

_NUMBERS: Final = (
    b"0", b"-1", b"1e400", b"-1e308", b"nan", b".nan", b"inf", b".inf", b"1e-320", b"9" * 400, b"9" * 5000,
    b"0x" + b"f" * 300, b"1:2:3", b"0b1", b"1_000", b"007", b"2001-99-99", b"2001-01-01", b"1,5", b"+", b"\xd9\xa3",
)  # fmt: skip
_MARKS: Final = (
    b"[", b"]", b"{", b"}", b",", b":", b": ", b"- ", b"? ", b"&a ", b"*a", b"<<: ", b"!!python/object:os.system ",
    b"!!binary ", b"!!set ", b"!!timestamp ", b"!", b"|\n", b">-\n", b'"', b"'", b"#", b"%YAML 9.9\n",
    b"---\n", b"...\n",
    b"\n", b"\r\n", b"\t", b"  ", b" ", b"\0", b"\xff", b"\xfe", b"\xc2", b"\xef\xbb\xbf", b"~", b"null", b"yes",
    b"drive",
    b"../../", b"/dev/zero", b"\\", b"=", b";", b"&", b"%00", b"..", b"\xe2\x80\xa8",
)  # fmt: skip
_REPEATED: Final = (
    b"[",
    b"{a: ",
    b"- ",
    b"a: {",
    b"[[",
    b'{"a":',
    b"x",
    b"0,",
    b",",
    b"\n",
    b"*a,",
    b"\x00",
    b"#",
)


def mutated(seed: bytes, others: tuple[bytes, ...], random: Random) -> bytes:
    """A seed with one to eight damages, or, one time in forty, nothing but noise."""
    if random.random() < 0.025:
        return random.randbytes(random.randint(0, 400))
    data = bytearray(seed)
    for _ in range(random.choice((1, 1, 1, 2, 3, 5, 8))):
        _damage(data, others, random)
    return bytes(data[:LARGEST])


def _damage(data: bytearray, others: tuple[bytes, ...], random: Random) -> None:
    at = random.randrange(len(data) + 1)
    end = min(len(data), at + random.choice((1, 2, 4, 16, 64, 1000)))
    kind = random.random()
    if kind < 0.25 and at < len(data):
        data[at] ^= 1 << random.randrange(8)
    elif kind < 0.35:
        data[at:end] = b""
    elif kind < 0.40:
        del data[at:]
    elif kind < 0.60:
        data[at:at] = random.choice(_MARKS)
    elif kind < 0.75:
        data[at : min(end, at + 4)] = random.choice(_NUMBERS)
    elif kind < 0.82:
        data[at:at] = data[at:end] * random.choice((1, 2, 10))
    elif kind < 0.87:
        data[at:at] = random.choice(_REPEATED) * random.choice((3, 30, 300, 3000, 30_000))
    elif kind < 0.94:
        other = random.choice(others)
        begin = random.randrange(len(other) + 1)
        data[at:end] = other[begin : begin + random.choice((4, 40, 400))]
    else:
        _number_elsewhere(data, random)


def _number_elsewhere(data: bytearray, random: Random) -> None:
    """Another number in the place of one that is there."""
    places = [index for index, byte in enumerate(data[:4000]) if 48 <= byte <= 57]
    if places:
        at = random.choice(places)
        data[at : at + 1] = random.choice(_NUMBERS)
