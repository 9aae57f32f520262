"""The device: versions, name, address, firmware download mode, and the raw receive buffers.

Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Final, final

from firmware_protocol.command import NoData, ReplyData, SystemCommand
from firmware_protocol.fields import U8, U32, Bytes4, Bytes7, Name15, Name16, PollBuffer8, Rest
from firmware_protocol.wire import FixedBytes

BOOT_MAGIC: Final = b"Let's dance: SAMBA\0"


@final
@dataclass(frozen=True)
class GetVersions(SystemCommand["GetVersions.Reply"], opcode=0x88, name="VERSIONS"):
    """Ask for the versions of protocol and firmware."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """Both versions, the minor number first."""

        protocol_minor: U8
        protocol_major: U8
        firmware_minor: U8
        firmware_major: U8


@final
@dataclass(frozen=True)
class Boot(SystemCommand["Boot.Reply"], opcode=0x97, name="BOOT"):
    """Put the brick into firmware download mode, USB only; it then no longer speaks this language."""

    magic: Annotated[bytes, FixedBytes(len(BOOT_MAGIC))] = BOOT_MAGIC

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The brick's consent; on an error, zeros."""

        answer: Bytes4 = b"Yes\0"


@final
@dataclass(frozen=True)
class SetBrickName(SystemCommand[NoData], opcode=0x98, name="SET_BRICK_NAME"):
    """Name the brick; 15 characters are kept. Over Bluetooth, telegrams of the next second can be lost."""

    name: Name16


@final
@dataclass(frozen=True)
class BluetoothGetAddress(SystemCommand["BluetoothGetAddress.Reply"], opcode=0x9A, name="BT_GET_ADDR"):
    """Ask for the Bluetooth address."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The six bytes of the address and a zero."""

        address: Bytes7


@final
@dataclass(frozen=True)
class GetDeviceInfo(SystemCommand["GetDeviceInfo.Reply"], opcode=0x9B, name="DEVICE_INFO"):
    """Ask who the brick is."""

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """Name, Bluetooth address (and a zero), the link quality of each connection, and free flash bytes."""

        name: Name15
        address: Bytes7
        link_quality: Bytes4
        free_flash: U32


@final
@dataclass(frozen=True)
class PollLength(SystemCommand["PollLength.Reply"], opcode=0xA1, name="POLL_LENGTH"):
    """Ask how many bytes wait in a buffer."""

    buffer: PollBuffer8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """How many bytes wait."""

        buffer: PollBuffer8
        available: U8


@final
@dataclass(frozen=True)
class Poll(SystemCommand["Poll.Reply"], opcode=0xA2, name="POLL"):
    """Take bytes out of a buffer; more than 57 over USB or 121 over Bluetooth is refused without data."""

    buffer: PollBuffer8
    length: U8

    @final
    @dataclass(frozen=True)
    class Reply(ReplyData):
        """The bytes, padded with zeros to the length requested; `received` is without the padding."""

        buffer: PollBuffer8
        count: U8
        data: Rest

        @property
        def received(self) -> bytes:
            """The bytes that were in the buffer."""
            return self.data[: self.count]


@final
@dataclass(frozen=True)
class BluetoothFactoryReset(SystemCommand[NoData], opcode=0xA4, name="BT_FACTORY_RESET"):
    """Forget all Bluetooth settings, USB only."""
