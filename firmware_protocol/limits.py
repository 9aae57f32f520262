"""Sizes and counts that the firmware fixes.

Source: LEGO NXT firmware 1.29, c_cmd.c, c_comm.c and c_loader.c; block sizes follow from the buffers' sizes.
"""

from __future__ import annotations

from typing import Final

from firmware_protocol.enums import ModuleId

FIRMWARE_VERSION: Final = (1, 29)
PROTOCOL_VERSION: Final = (1, 124)

SCHEDULER_PERIOD_MS: Final = 1
"""At most one telegram of each transport is taken per pass of the scheduler."""

OUTPUT_PORT_COUNT: Final = 3
INPUT_PORT_COUNT: Final = 4

MAILBOX_COUNT: Final = 20
"""Mailboxes 0 to 9 are for messages to the brick, 10 to 19 for messages from it."""
INBOX_COUNT: Final = 10
MAILBOX_DEPTH: Final = 5
"""Messages that a mailbox keeps; a further one drops the oldest."""
MESSAGE_SIZE: Final = 59
"""The longest message, its final NUL counted."""
DATALOG_SIZE: Final = 60

LOW_SPEED_BUFFER_SIZE: Final = 16
"""The most bytes one transaction with a digital sensor sends or receives."""

VOLUME_MAX: Final = 4

FILE_HANDLE_COUNT: Final = 16
FILE_COUNT: Final = 127
WRITE_BUFFER_COUNT: Final = 4
SECTOR_SIZE: Final = 256

BRICK_NAME_SIZE: Final = 15
"""Characters of a brick's name that SET_BRICK_NAME keeps."""
BLUETOOTH_CONTACT_COUNT: Final = 30
BLUETOOTH_CONNECTION_COUNT: Final = 4

READ_SIZE_USB: Final = 58
READ_SIZE_BLUETOOTH: Final = 122
"""File bytes in one READ reply."""
IO_MAP_SIZE_USB: Final = 55
IO_MAP_SIZE_BLUETOOTH: Final = 119
"""IO map bytes in one IOMAP_READ reply."""
POLL_SIZE_USB: Final = 59
POLL_SIZE_BLUETOOTH: Final = 121
"""Buffer bytes in one POLL reply; more is refused."""

IO_MAP_SIZES: Final = {
    ModuleId.INPUT: 416,
    ModuleId.BUTTON: 36,
    ModuleId.LOADER: 8,
    ModuleId.LOW_SPEED: 167,
    ModuleId.OUTPUT: 100,
    ModuleId.SOUND: 30,
    ModuleId.IO_CTRL: 2,
    ModuleId.COMM: 1896,
    ModuleId.COMMAND: 32828,
    ModuleId.UI: 40,
}
"""Bytes of the modules' IO maps, where known."""
