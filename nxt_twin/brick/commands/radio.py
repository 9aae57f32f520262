"""The brick's own Bluetooth radio: its address, switch and tables."""

from __future__ import annotations

from typing import NamedTuple, final

from firmware_protocol import (
    BluetoothConnectionCount,
    BluetoothConnectionName,
    BluetoothContactCount,
    BluetoothContactName,
    BluetoothFactoryReset,
    BluetoothGetAddress,
    GetProperty,
    PropertyId,
    SetProperty,
)
from firmware_protocol.bluetooth import address_text
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped


class Peer(NamedTuple):
    """A device in one of the radio's tables.

    Attributes:
        device_type: how the firmware classes it; 0 for an empty place.
        name: the device's name.
    """

    device_type: int
    name: str


@final
class Radio:
    """The Bluetooth settings of a brick; every method raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    def address(self) -> Stamped[str]:
        """The Bluetooth address, such as ``00:16:53:01:02:03``."""
        reply = self._exchange.ask(BluetoothGetAddress())
        return reply.having(address_text(reply.value.address))

    def is_on(self) -> Stamped[bool]:
        """Whether the radio is switched on."""
        reply = self._exchange.ask(GetProperty(PropertyId.BLUETOOTH_ON))
        return reply.having(reply.value.value != 0)

    def switch(self, *, on: bool) -> Stamped[None]:
        """Switch the radio; off ends a connection over Bluetooth."""
        return self._exchange.ask(SetProperty(PropertyId.BLUETOOTH_ON, int(on))).having(None)

    def contact_count(self) -> Stamped[int]:
        """The size of the table of known devices, full or not."""
        reply = self._exchange.ask(BluetoothContactCount())
        return reply.having(reply.value.count)

    def contact(self, index: int) -> Stamped[Peer]:
        """One entry of the table of known devices."""
        reply = self._exchange.ask(BluetoothContactName(index))
        return reply.having(Peer(reply.value.device_type, reply.value.name))

    def connection_count(self) -> Stamped[int]:
        """The size of the table of connections, full or not."""
        reply = self._exchange.ask(BluetoothConnectionCount())
        return reply.having(reply.value.count)

    def connection(self, index: int) -> Stamped[Peer]:
        """One entry of the table of connections."""
        reply = self._exchange.ask(BluetoothConnectionName(index))
        return reply.having(Peer(reply.value.device_type, reply.value.name))

    def factory_reset(self) -> Stamped[None]:
        """Forget all Bluetooth settings; the brick refuses it over Bluetooth."""
        return self._exchange.ask(BluetoothFactoryReset()).having(None)
