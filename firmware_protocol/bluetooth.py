"""What identifies and carries an NXT on Bluetooth: the serial port profile, each telegram in a frame.

Source: LEGO NXT firmware 1.29, d_bt.r and c_comm.c; the PIN is from LEGO's developer kit.
"""

from __future__ import annotations

from typing import Final

CHANNEL: Final = 1
"""RFCOMM channel."""
DEFAULT_PIN: Final = "1234"
ADDRESS_PREFIX: Final = "00:16:53"
"""LEGO's share of the address space (OUI)."""
DEVICE_CLASS: Final = 0x000804
"""A toy robot."""

LENGTH_PREFIX_SIZE: Final = 2
FRAME_SIZE_MAX: Final = 0xFFFF
"""The longest telegram that the length prefix can announce."""
RECEIVE_BUFFER_SIZE: Final = 128
"""The firmware takes a longer telegram in pieces of this size."""


def address_text(address: bytes) -> str:
    """The address, as ``00:16:53:…``, of the six or seven bytes that the brick reports (the seventh is 0)."""
    return ":".join(f"{byte:02X}" for byte in address[:6])
