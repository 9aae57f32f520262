"""What identifies and carries an NXT on USB. One telegram is one bulk packet, without a length prefix.

Source: LEGO NXT firmware 1.29, USB descriptors.
"""

from __future__ import annotations

from typing import Final

VENDOR_ID: Final = 0x0694
PRODUCT_ID: Final = 0x0002
ENDPOINT_OUT: Final = 0x01
ENDPOINT_IN: Final = 0x82
PACKET_SIZE: Final = 64
"""The longest telegram, either way."""
CONTROL_PACKET_SIZE: Final = 8
INTERFACE_CLASS: Final = (0xFF, 0xFF, 0xFF)
"""Class, subclass and protocol of the one interface: vendor specific."""

BOOT_VENDOR_ID: Final = 0x03EB
BOOT_PRODUCT_ID: Final = 0x6124
"""A brick in firmware download mode is this other device (Atmel's SAM-BA), which speaks another language."""


def bluetooth_address(serial_number: str) -> str:
    """The Bluetooth address, as ``00:16:53:…``, that the twelve digits of the USB serial number spell."""
    return ":".join(serial_number[at : at + 2].upper() for at in range(0, len(serial_number), 2))
