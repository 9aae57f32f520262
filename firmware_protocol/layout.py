"""Packs and unpacks structures, which are frozen dataclasses whose fields say how they lie on the wire."""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, TypeVar, final, get_type_hints

from firmware_protocol.errors import (
    FieldPathError,
    FieldValueError,
    TelegramTooShortError,
    TrailingBytesError,
)
from firmware_protocol.wire import FixedWire, Wire


class WireStructure(ABC):  # noqa: B024 - what subclasses have to give are the fields
    """Abstract: a frozen dataclass with an ``Annotated[type, Wire]`` for each field, in wire order."""


StructureT = TypeVar("StructureT", bound=WireStructure)


@final
@dataclass(frozen=True)
class Field:
    """One field of a declaration.

    Args:
        name: the dataclass field's name.
        wire: how it lies on the wire.
        offset: bytes from the structure's start, or None behind a field of variable width.
    """

    name: str
    wire: Wire
    offset: int | None


@cache
def fields_of(structure: type[WireStructure]) -> tuple[Field, ...]:
    """The fields of a declaration, in the order of the wire."""
    hints = get_type_hints(structure, include_extras=True)
    laid_out: list[Field] = []
    offset: int | None = 0
    for declared in fields(structure):  # type: ignore[arg-type]  # every WireStructure is a dataclass
        wire = next(mark for mark in hints[declared.name].__metadata__ if isinstance(mark, Wire))
        laid_out.append(Field(declared.name, wire, offset))
        width = wire.fixed_width
        offset = None if offset is None or width is None else offset + width
    return tuple(laid_out)


def fixed_size_of(structure: type[WireStructure]) -> int | None:
    """The structure's number of bytes, or None if it depends on the telegram."""
    widths = [field.wire.fixed_width for field in fields_of(structure)]
    known = [width for width in widths if width is not None]
    return sum(known) if len(known) == len(widths) else None


def describe(structure: type[WireStructure]) -> str:
    """The layout in words, such as ``mailbox u8, size u8, data bytes[size]``; empty for no fields."""
    return ", ".join(f"{field.name} {field.wire.label}" for field in fields_of(structure))


def pack(structure: WireStructure) -> bytes:
    """The bytes of a structure.

    Raises:
        FieldValueError: a value does not fit its field.
    """
    values = vars(structure)
    packed = bytearray()
    for field in fields_of(type(structure)):
        value = values[field.name]
        given = len(value) if isinstance(value, bytes | bytearray) else 0
        try:
            packed += field.wire.pack(value, field.wire.width(values, given))
        except FieldValueError as error:
            raise FieldValueError(f"{type(structure).__qualname__}.{field.name}: {error}") from None
    return bytes(packed)


def unpack(structure: type[StructureT], data: bytes) -> StructureT:
    """The structure that fills the bytes exactly.

    Raises:
        TelegramTooShortError: the bytes end before the last field does.
        TrailingBytesError: the bytes go on after the last field.
    """
    values: dict[str, Any] = {}
    position = 0
    for field in fields_of(structure):
        left = len(data) - position
        width = field.wire.width(values, left)
        if width > left:
            place = f"{structure.__qualname__}.{field.name}"
            raise TelegramTooShortError(f"{place} takes {width} bytes where {left} are left")
        values[field.name] = field.wire.unpack(data[position : position + width])
        position += width
    if position < len(data):
        surplus = len(data) - position
        raise TrailingBytesError(f"{surplus} bytes go on after the end of {structure.__qualname__}")
    return structure(**values)


def unpack_loosely(structure: type[StructureT], buffer: bytes, *, start: int, end: int) -> StructureT:
    """The structure that a reader without length checks sees in a buffer; never fails.

    Args:
        structure: what to read.
        buffer: all memory within the reader's reach; bytes beyond it read as 0.
        start: where the structure starts in the buffer.
        end: where the telegram ends, which bounds only a field that takes all remaining bytes.
    """
    values: dict[str, Any] = {}
    position = start
    for field in fields_of(structure):
        width = field.wire.width(values, max(0, end - position))
        values[field.name] = field.wire.unpack(buffer[position : position + width].ljust(width, b"\0"))
        position += width
    return structure(**values)


@final
@dataclass(frozen=True)
class Block(FixedWire):
    """A structure of fixed size inside another."""

    structure: type[WireStructure]

    @property
    def label(self) -> str:
        """The structure's name."""
        return self.structure.__name__

    @property
    def fixed_width(self) -> int:
        """The structure's number of bytes."""
        size = fixed_size_of(self.structure)
        if size is None:
            raise FieldPathError(f"{self.structure.__qualname__} has no fixed size and cannot be a block")
        return size

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401 - what fits is each kind's own business
        """The bytes of a structure."""
        if not isinstance(value, self.structure):
            raise FieldValueError(f"{value!r} is not a {self.structure.__qualname__} of {width} bytes")
        return pack(value)

    def unpack(self, raw: bytes) -> WireStructure:
        """The structure."""
        return unpack(self.structure, raw)


@final
@dataclass(frozen=True)
class Repeat(FixedWire):
    """A tuple of ``count`` values of one kind, one after the other."""

    count: int
    element: FixedWire

    @property
    def label(self) -> str:
        """The element's label behind the count, such as ``4 × u8``."""
        return f"{self.count} × {self.element.label}"

    @property
    def fixed_width(self) -> int:
        """The number of bytes of all together."""
        return self.count * self.element.fixed_width

    def pack(self, value: Any, width: int) -> bytes:  # noqa: ANN401
        """The bytes of a tuple."""
        if not isinstance(value, tuple) or len(value) != self.count:
            raise FieldValueError(f"{value!r} is not a tuple of {self.count}, which {width} bytes hold")
        return b"".join(self.element.pack(each, self.element.fixed_width) for each in value)

    def unpack(self, raw: bytes) -> tuple[Any, ...]:
        """The tuple."""
        step = self.element.fixed_width
        return tuple(self.element.unpack(raw[at : at + step]) for at in range(0, len(raw), step))


def field_named(structure: type[WireStructure], name: str) -> Field:
    """The field of that name.

    Raises:
        FieldPathError: there is none; the message lists those there are.
    """
    found: Mapping[str, Field] = {field.name: field for field in fields_of(structure)}
    if name not in found:
        raise FieldPathError(f"{structure.__qualname__} has no field {name!r}; it has {', '.join(found)}")
    return found[name]
