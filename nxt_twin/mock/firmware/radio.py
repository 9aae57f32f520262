"""The comm module's memory: who the brick is, whom it knows by Bluetooth, and how long its radio is busy.

Source: LEGO NXT firmware 1.29, c_comm.c and c_comm.iom.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

from firmware_protocol import ModuleId, limits
from nxt_twin.mock.firmware.module import Module, overlay

RENAME_MS: Final = 1000
"""How long the radio is busy with a new name, out of stream mode."""

_CONTACT_OFFSET: Final = 8
_CONTACT_STRIDE: Final = 31
_CONNECTION_OFFSET: Final = 938
_CONNECTION_STRIDE: Final = 47
_CONNECTION_QUALITY: Final = 45
_NAME_OFFSET: Final = 1126
_ADDRESS_OFFSET: Final = 1144
_NAME_FIELD: Final = 16
_ADDRESS_FIELD: Final = 7
_PIN_FIELD: Final = 16
_KNOWN: Final = 2
_CLASSES: Final = {1: 0x0804, 2: 0x0200, 3: 0x0100}
"""Bluetooth's class for each device type: NXT, phone, PC."""


@final
@dataclass(frozen=True)
class Contact:
    """A Bluetooth device that the brick knows, or is connected to; unused entries are blank."""

    device_type: int = 0
    name: str = ""
    address: bytes = bytes(_ADDRESS_FIELD)

    def in_contacts(self) -> bytes:
        """The entry as the table of contacts holds it: name, class, address, status."""
        status = _KNOWN if self.name else 0
        return self._head() + self.address + bytes((status,))

    def in_connections(self) -> bytes:
        """The entry as the table of connections starts it: name, class, PIN (blank), address."""
        return self._head() + bytes(_PIN_FIELD) + self.address

    def _head(self) -> bytes:
        name = self.name.encode("latin-1", "replace")[: _NAME_FIELD - 1]
        return name.ljust(_NAME_FIELD, b"\0") + _CLASSES.get(self.device_type, 0).to_bytes(4, "big")


@final
class RadioModule(Module):
    """Identity and Bluetooth tables."""

    module_id = ModuleId.COMM
    name = "Comm.mod"

    def __init__(self, brick_name: str, address: bytes) -> None:
        self.brick_name = brick_name
        self.address = address + b"\0"
        self.contacts = [Contact()] * limits.BLUETOOTH_CONTACT_COUNT
        self.connections = [Contact()] * limits.BLUETOOTH_CONNECTION_COUNT
        self.link_quality = bytes(limits.BLUETOOTH_CONNECTION_COUNT)
        self.reading = False
        """Whether it carries a long READ."""
        self._busy_ms = 0
        self._memory = bytes(limits.IO_MAP_SIZES[ModuleId.COMM])

    @property
    def away(self) -> bool:
        """Whether the radio is out of stream mode."""
        return self._busy_ms > 0

    @property
    def busy(self) -> bool:
        """Whether the radio takes no other job."""
        return self.away or self.reading

    def rename(self, name: str) -> bool:
        """Take a new name, of which 15 characters are kept; False while the radio is busy."""
        if self.busy:
            return False
        self.brick_name = name[: limits.BRICK_NAME_SIZE]
        self._busy_ms = RENAME_MS
        return True

    def factory_reset(self) -> bool:
        """Forget all contacts; False while the radio is busy."""
        if self.busy:
            return False
        self.contacts = [Contact()] * limits.BLUETOOTH_CONTACT_COUNT
        self._busy_ms = RENAME_MS
        return True

    def tick(self) -> None:
        """One pass."""
        if self._busy_ms:
            self._busy_ms -= 1

    def export(self) -> bytes:
        """The IO map, with the tables and the identity in their places."""
        memory = self._memory
        for index, contact in enumerate(self.contacts):
            memory = overlay(memory, _CONTACT_OFFSET + index * _CONTACT_STRIDE, contact.in_contacts())
        for index, connection in enumerate(self.connections):
            at = _CONNECTION_OFFSET + index * _CONNECTION_STRIDE
            memory = overlay(memory, at, connection.in_connections())
            memory = overlay(memory, at + _CONNECTION_QUALITY, self.link_quality[index : index + 1])
        name = self.brick_name.encode("latin-1", "replace").ljust(_NAME_FIELD, b"\0")
        memory = overlay(memory, _NAME_OFFSET, name)
        return overlay(memory, _ADDRESS_OFFSET, self.address)

    def adopt(self, data: bytes) -> None:
        """Take over the memory; identity and tables are the radio's own and stay."""
        self._memory = data
