"""The brick as a whole: battery, sleep, properties, and its Bluetooth tables.

Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Final, Self, final

from firmware_protocol.command import DirectCommand, NoData, ReplyData
from firmware_protocol.enums import PropertyId
from firmware_protocol.fields import U8, U16, U32, Name17, PropertyId8, Rest
from firmware_protocol.wire import NumberBy

_PROPERTY_SIZES: Final = (
    (PropertyId.BLUETOOTH_ON, 1),
    (PropertyId.VOLUME, 1),
    (PropertyId.SLEEP_TIMEOUT, 4),
)


@final
@dataclass(frozen=True)
class GetBatteryLevel(DirectCommand["GetBatteryLevel.Reply"], opcode=0x0B, name="GET_BATT_LVL"):
    """Read the battery voltage, which the brick measures anew every 167 ms."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The voltage in mV, in steps of 13.848 mV."""

        voltage_mv: U16


@final
@dataclass(frozen=True)
class KeepAlive(DirectCommand["KeepAlive.Reply"], opcode=0x0D, name="KEEP_ALIVE"):
    """Restart the sleep timer."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The time until the brick switches itself off; 0 for never."""

        sleep_timeout_ms: U32


@final
@dataclass(frozen=True)
class BluetoothContactCount(
    DirectCommand["BluetoothContactCount.Reply"], opcode=0x1B, name="BT_CONTACT_COUNT"
):
    """Ask for the size of the table of known devices."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The table's size, full or not: 30."""

        count: U8


@final
@dataclass(frozen=True)
class BluetoothContactName(DirectCommand["BluetoothContactName.Reply"], opcode=0x1C, name="BT_CONTACT_NAME"):
    """Read one entry of the table of known devices."""

    index: U8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The device's type and name."""

        device_type: U8
        name: Name17


@final
@dataclass(frozen=True)
class BluetoothConnectionCount(
    DirectCommand["BluetoothConnectionCount.Reply"], opcode=0x1D, name="BT_CONNECTION_COUNT"
):
    """Ask for the size of the table of connections."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The table's size, full or not: 4."""

        count: U8


@final
@dataclass(frozen=True)
class BluetoothConnectionName(
    DirectCommand["BluetoothConnectionName.Reply"], opcode=0x1E, name="BT_CONNECTION_NAME"
):
    """Read one entry of the table of connections."""

    index: U8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The connected device's type and name."""

        device_type: U8
        name: Name17


@final
@dataclass(frozen=True)
class SetProperty(DirectCommand[NoData], opcode=0x1F, name="SET_PROPERTY"):
    """Switch Bluetooth, set the volume (above 4 becomes 4) or the sleep timeout in ms (cut to minutes)."""

    property_id: PropertyId8
    value: Annotated[int, NumberBy("property_id", _PROPERTY_SIZES)]


@final
@dataclass(frozen=True)
class GetProperty(DirectCommand["GetProperty.Reply"], opcode=0x20, name="GET_PROPERTY"):
    """Read a property; an id that the brick does not have is answered as an unknown command."""

    property_id: PropertyId8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The value, in one or four bytes by the property asked for."""

        data: Rest

        @classmethod
        def of(cls, property_id: int, value: int) -> Self:
            """The reply that carries a property's value."""
            return cls(value.to_bytes(dict(_PROPERTY_SIZES)[PropertyId(property_id)], "little"))

        @property
        def value(self) -> int:
            """The value as a number."""
            return int.from_bytes(self.data, "little")
