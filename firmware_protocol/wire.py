"""How one value lies on the wire: the kinds of field, each able to size, pack and unpack itself.

All integers are little-endian.
"""

from __future__ import annotations

import operator
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import Any, final

from firmware_protocol.errors import FieldValueError


class Wire(ABC):
    """One kind of field. Instances stand in the ``Annotated`` types of a declaration's fields."""

    @property
    @abstractmethod
    def label(self) -> str:
        """The kind in the words of the telegram tables, such as ``u16``."""

    @property
    def fixed_width(self) -> int | None:
        """The number of bytes, or None where it depends on the telegram."""
        return None

    @abstractmethod
    def width(self, earlier: Mapping[str, Any], left: int) -> int:
        """The number of bytes in one telegram.

        Args:
            earlier: the values of the fields before this one.
            left: how many bytes the telegram still has.
        """

    @abstractmethod
    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401 - what fits is each kind's own business
        """The bytes of a value.

        Raises:
            FieldValueError: the value does not fit.
        """

    @abstractmethod
    def unpack(self, raw: bytes) -> Any:  # noqa: ANN401
        """The value of the bytes; any bytes of the right number have one."""


class FixedWire(Wire):
    """A kind whose width is in its declaration."""

    @property
    @abstractmethod
    def fixed_width(self) -> int:
        """The number of bytes."""

    def width(self, earlier: Mapping[str, Any], left: int) -> int:
        """The declared number of bytes, whatever the telegram."""
        del earlier, left
        return self.fixed_width


@final
@dataclass(frozen=True)
class Number(FixedWire):
    """An integer of ``size`` bytes."""

    size: int
    signed: bool = False

    @property
    def label(self) -> str:
        """Such as ``u8`` or ``s16``."""
        return f"{'s' if self.signed else 'u'}{8 * self.size}"

    @property
    def fixed_width(self) -> int:
        """The number of bytes."""
        return self.size

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes of an integer (anything with ``__index__``)."""
        return _integer_bytes(value, width, signed=self.signed)

    def unpack(self, raw: bytes) -> int:
        """The integer."""
        return int.from_bytes(raw, "little", signed=self.signed)


@final
@dataclass(frozen=True)
class Choice(FixedWire):
    """An unsigned integer whose values have names; those without one stay plain integers."""

    meaning: type[IntEnum] | type[IntFlag]
    size: int = 1

    @property
    def label(self) -> str:
        """Such as ``u8 OutputPort``."""
        return f"u{8 * self.size} {self.meaning.__name__}"

    @property
    def fixed_width(self) -> int:
        """The number of bytes."""
        return self.size

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes of a member or of a plain integer."""
        return _integer_bytes(value, width, signed=False)

    def unpack(self, raw: bytes) -> int:
        """The member, or the plain integer where there is none."""
        number = int.from_bytes(raw, "little")
        try:
            return self.meaning(number)
        except ValueError:
            return number


@final
@dataclass(frozen=True)
class Truth(FixedWire):
    """One byte: 0 is false, all else true; true is sent as 1."""

    @property
    def label(self) -> str:
        """``bool8``."""
        return "bool8"

    @property
    def fixed_width(self) -> int:
        """One byte."""
        return 1

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """0 or 1."""
        return _integer_bytes(bool(value), width, signed=False)

    def unpack(self, raw: bytes) -> bool:
        """Whether the byte is not 0."""
        return any(raw)


@final
@dataclass(frozen=True)
class Text(FixedWire):
    """A name of up to ``size`` Latin-1 characters, padded with NUL; it ends at the first NUL.

    The terminator may be missing, as it may in the firmware's buffer; `check_file_name` is the stricter rule.
    """

    size: int

    @property
    def label(self) -> str:
        """Such as ``name20``."""
        return f"name{self.size}"

    @property
    def fixed_width(self) -> int:
        """The number of bytes."""
        return self.size

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The padded bytes of a string."""
        try:
            raw = bytes(value, "latin-1")
        except (TypeError, UnicodeEncodeError):
            raise FieldValueError(f"{value!r} is not a Latin-1 text") from None
        if len(raw) > width or b"\0" in raw:
            raise FieldValueError(f"{value!r} does not fit {width} bytes that end at the first NUL")
        return raw.ljust(width, b"\0")

    def unpack(self, raw: bytes) -> str:
        """The text up to the first NUL."""
        return raw.partition(b"\0")[0].decode("latin-1")


@final
@dataclass(frozen=True)
class FixedBytes(FixedWire):
    """Exactly ``size`` bytes."""

    size: int

    @property
    def label(self) -> str:
        """Such as ``bytes16``."""
        return f"bytes{self.size}"

    @property
    def fixed_width(self) -> int:
        """The number of bytes."""
        return self.size

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes themselves."""
        return _exact_bytes(value, width)

    def unpack(self, raw: bytes) -> bytes:
        """The bytes themselves."""
        return raw


@final
@dataclass(frozen=True)
class Counted(Wire):
    """As many bytes as the earlier field ``count`` says."""

    count: str

    @property
    def label(self) -> str:
        """Such as ``bytes[size]``."""
        return f"bytes[{self.count}]"

    def width(self, earlier: Mapping[str, Any], left: int) -> int:
        """The number that the counting field holds."""
        del left
        return operator.index(earlier[self.count])

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes themselves."""
        return _exact_bytes(value, width)

    def unpack(self, raw: bytes) -> bytes:
        """The bytes themselves."""
        return raw


@final
@dataclass(frozen=True)
class Remaining(Wire):
    """All bytes up to the telegram's end."""

    @property
    def label(self) -> str:
        """``rest``."""
        return "rest"

    def width(self, earlier: Mapping[str, Any], left: int) -> int:
        """All that is left."""
        del earlier
        return left

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes themselves."""
        return _exact_bytes(value, width)

    def unpack(self, raw: bytes) -> bytes:
        """The bytes themselves."""
        return raw


@final
@dataclass(frozen=True)
class NumberBy(Wire):
    """An unsigned integer as wide as an earlier field says; no bytes, and 0, where that is not listed."""

    selector: str
    sizes: tuple[tuple[int, int], ...]

    @property
    def label(self) -> str:
        """Such as ``u8|u32 by property_id``."""
        kinds = dict.fromkeys(f"u{8 * size}" for _, size in self.sizes)
        return f"{'|'.join(kinds)} by {self.selector}"

    def width(self, earlier: Mapping[str, Any], left: int) -> int:
        """The width listed for the selecting field's value."""
        del left
        return dict(self.sizes).get(earlier[self.selector], 0)

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes of an integer (anything with ``__index__``)."""
        return _integer_bytes(value, width, signed=False)

    def unpack(self, raw: bytes) -> int:
        """The integer."""
        return int.from_bytes(raw, "little")


def _integer_bytes(value: Any, width: int, *, signed: bool) -> bytes:  # noqa: ANN401
    try:
        return operator.index(value).to_bytes(width, "little", signed=signed)
    except (TypeError, OverflowError):
        kind = "signed" if signed else "unsigned"
        raise FieldValueError(f"{value!r} is not an {kind} integer of {width} bytes") from None


def _exact_bytes(value: Any, width: int) -> bytes:  # noqa: ANN401
    if not isinstance(value, bytes | bytearray | memoryview):
        raise FieldValueError(f"{value!r} is not bytes")
    raw = bytes(value)
    if len(raw) != width:
        raise FieldValueError(f"{len(raw)} bytes were given where {width} belong")
    return raw
