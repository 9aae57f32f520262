"""Hypothesis strategies made from the declarations: any request, any reply, any IO map."""

from __future__ import annotations

from typing import Any, TypeVar

from hypothesis import strategies as st

from firmware_protocol import Command, all_commands
from firmware_protocol.layout import Block, Repeat, WireStructure, fields_of
from firmware_protocol.wire import (
    Choice,
    Counted,
    FixedBytes,
    Number,
    NumberBy,
    Remaining,
    Text,
    Truth,
    Wire,
)

StructureT = TypeVar("StructureT", bound=WireStructure)


def values_of(wire: Wire, earlier: dict[str, Any]) -> st.SearchStrategy[Any]:
    match wire:
        case Number(size=size, signed=True):
            return st.integers(-(1 << 8 * size - 1), (1 << 8 * size - 1) - 1)
        case Number(size=size) | Choice(size=size):
            return st.integers(0, (1 << 8 * size) - 1)
        case Truth():
            return st.booleans()
        case Text(size=size):
            return st.text(st.characters(min_codepoint=1, max_codepoint=0xFF), max_size=size)
        case FixedBytes(size=size):
            return st.binary(min_size=size, max_size=size)
        case Counted(count=count):
            return st.binary(min_size=earlier[count], max_size=earlier[count])
        case Remaining():
            return st.binary(max_size=200)
        case NumberBy():
            return st.integers(0, (1 << 8 * wire.width(earlier, 0)) - 1)
        case Block(structure=structure):
            return structures(structure)
        case Repeat(count=count, element=element):
            return st.tuples(*[values_of(element, {})] * count)
    raise AssertionError(f"no strategy for {wire}")


def structures(structure: type[StructureT]) -> st.SearchStrategy[StructureT]:
    @st.composite
    def draw_one(draw: st.DrawFn) -> StructureT:
        values: dict[str, Any] = {}
        for field in fields_of(structure):
            # A counter of two bytes is drawn small, so that the counted bytes stay a telegram's size.
            counts_bytes = any(
                isinstance(other.wire, Counted) and other.wire.count == field.name
                for other in fields_of(structure)
            )
            drawn = st.integers(0, 255) if counts_bytes else values_of(field.wire, values)
            values[field.name] = draw(drawn)
        return structure(**values)

    return draw_one()


def requests() -> st.SearchStrategy[Command[Any]]:
    return st.one_of([structures(command) for command in all_commands()])
