"""The firmware's modules, and the memory that each of them shares (its IO map)."""

from __future__ import annotations

from typing import Any, Final, NamedTuple, final

from firmware_protocol import (
    CloseModule,
    FieldValueError,
    FindFirstModule,
    FindNextModule,
    IoMapField,
    IoMapRead,
    IoMapWrite,
    ModuleFound,
    Status,
)
from nxt_twin.brick.errors import CommandRefusedError, GarbageError, RequestError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped

_READ_OVERHEAD: Final = 9
"""Bytes of an IOMAP_READ reply around the data: type, opcode, status, module, length."""
_WRITE_OVERHEAD: Final = 10
"""Bytes of an IOMAP_WRITE request around the data: type, opcode, module, offset, length."""


class ListedModule(NamedTuple):
    """A module of the firmware.

    Attributes:
        name: such as ``Output.mod``.
        module_id: what reads and writes name it by.
        io_map_bytes: the size of its IO map.
    """

    name: str
    module_id: int
    io_map_bytes: int


@final
class Modules:
    """The modules of a brick's firmware; every method raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange
        self._read_block = exchange.policy.telegram_size - _READ_OVERHEAD
        self._write_block = exchange.policy.telegram_size - _WRITE_OVERHEAD

    def find_first(self, pattern: str = "*.*") -> Stamped[ListedModule]:
        """Start the search for modules; there is only one at a time, until `close` ends it."""
        return _module(self._exchange.ask(FindFirstModule(pattern)))

    def find_next(self) -> Stamped[ListedModule]:
        """Go on with the search; status MODULE_NOT_FOUND at its end, which does not close it."""
        return _module(self._exchange.ask(FindNextModule(0)))

    def close(self) -> Stamped[None]:
        """End the search."""
        return self._exchange.ask(CloseModule(0)).having(None)

    def list(self) -> Stamped[tuple[ListedModule, ...]]:
        """All modules, in the brick's order."""
        first = found = self.find_first()
        modules: list[ListedModule] = []
        try:
            while True:
                modules.append(found.value)
                found = self.find_next()
        except CommandRefusedError as error:
            if error.status is not Status.MODULE_NOT_FOUND:
                raise
            return Stamped(tuple(modules), first.sent_s, error.received_s)
        finally:
            self.close()

    def read(self, module_id: int, offset: int, length: int) -> Stamped[bytes]:
        """Bytes of a module's IO map, in as many requests as it takes.

        Raises:
            GarbageError: the brick gave fewer bytes than asked for.
        """
        content = bytearray()
        stamps: list[Stamped[bytes]] = []
        for start in range(0, length, self._read_block):
            wanted = min(self._read_block, length - start)
            reply = self._exchange.ask(IoMapRead(module_id, offset + start, wanted))
            if len(reply.value.data) != wanted:
                raise GarbageError(f"the brick gave {len(reply.value.data)} bytes instead of {wanted}")
            content += reply.value.data
            stamps.append(reply.having(b""))
        if not stamps:
            raise RequestError("no bytes are to be read", where=f"module 0x{module_id:08X}")
        return Stamped(bytes(content), stamps[0].sent_s, stamps[-1].received_s)

    def write(self, module_id: int, offset: int, data: bytes) -> Stamped[None]:
        """Write bytes into a module's IO map; writing motors counts as engaging them.

        Raises:
            RequestError: there are none, or more than fit one telegram: the firmware acts between two.
        """
        if not 0 < len(data) <= self._write_block:
            raise RequestError(
                f"{len(data)} bytes cannot be written at once",
                where=f"module 0x{module_id:08X}",
                mend=f"1 to {self._write_block} can",
            )
        return self._exchange.ask(IoMapWrite.of(module_id, offset, data)).having(None)

    def read_field(self, field: IoMapField) -> Stamped[Any]:
        """The value of a field, a block or a whole map, as `firmware_protocol.locate` finds it."""
        reply = self.read(field.module_id, field.offset, field.length)
        return reply.having(field.decode(reply.value))

    def write_field(self, field: IoMapField, value: object) -> Stamped[None]:
        """Write a field.

        Raises:
            RequestError: the value does not fit.
        """
        try:
            request = field.write_request(value)
        except FieldValueError as error:
            raise RequestError(str(error)) from error
        return self.write(request.module_id, request.offset, request.data)


def _module(reply: Stamped[ModuleFound]) -> Stamped[ListedModule]:
    found = reply.value
    return reply.having(ListedModule(found.name, found.module_id, found.io_map_size))
