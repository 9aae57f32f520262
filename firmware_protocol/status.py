"""The status byte of a reply: what each value means, in words."""

from __future__ import annotations

from enum import IntEnum
from typing import Final


class Status(IntEnum):
    """The third byte of every reply.

    Any byte is a status: one that the firmware does not define becomes a member named ``UNKNOWN_xx``.
    Source: LEGO NXT firmware 1.29, status codes of the loader, the low-speed bus and the command interpreter.
    """

    OK = 0x00
    DATALOG_WRAPPED = 0x10
    PENDING = 0x20
    MAILBOX_EMPTY = 0x40

    NO_MORE_HANDLES = 0x81
    NO_SPACE = 0x82
    NO_MORE_FILES = 0x83
    END_OF_FILE_EXPECTED = 0x84
    END_OF_FILE = 0x85
    NOT_A_LINEAR_FILE = 0x86
    FILE_NOT_FOUND = 0x87
    HANDLE_ALREADY_CLOSED = 0x88
    NO_LINEAR_SPACE = 0x89
    UNDEFINED_ERROR = 0x8A
    FILE_IS_BUSY = 0x8B
    NO_WRITE_BUFFERS = 0x8C
    APPEND_NOT_POSSIBLE = 0x8D
    FILE_IS_FULL = 0x8E
    FILE_EXISTS = 0x8F
    MODULE_NOT_FOUND = 0x90
    OUT_OF_BOUNDS = 0x91
    ILLEGAL_FILE_NAME = 0x92
    ILLEGAL_HANDLE = 0x93

    BLUETOOTH_BUSY = 0x94
    CONNECT_FAILED = 0x95
    BLUETOOTH_TIMEOUT = 0x96
    TRANSFER_TIMEOUT = 0x97
    TRANSFER_FILE_EXISTS = 0x98
    TRANSFER_FILE_MISSING = 0x99
    TRANSFER_STREAM_ERROR = 0x9A
    TRANSFER_CLOSE_ERROR = 0x9B

    REQUEST_FAILED = 0xBD
    UNKNOWN_OPCODE = 0xBE
    INSANE_PACKET = 0xBF
    VALUE_OUT_OF_RANGE = 0xC0
    BUS_ERROR = 0xDD
    BUFFER_FULL = 0xDE
    CHANNEL_INVALID = 0xDF
    CHANNEL_NOT_READY = 0xE0
    NO_ACTIVE_PROGRAM = 0xEC
    ILLEGAL_SIZE = 0xED
    ILLEGAL_MAILBOX = 0xEE
    INVALID_FIELD = 0xEF
    BAD_PORT = 0xF0
    BAD_POINTER = 0xFA
    NO_MEMORY = 0xFB
    WRONG_VERSION = 0xFC
    BAD_FILE = 0xFD
    BAD_INSTRUCTION = 0xFE
    BAD_ARGUMENT = 0xFF

    @classmethod
    def _missing_(cls, value: object) -> Status | None:
        if not isinstance(value, int) or not 0 <= value <= 0xFF:
            return None
        unknown = int.__new__(cls, value)
        unknown._name_ = f"UNKNOWN_{value:02X}"
        unknown._value_ = value
        return unknown

    def __reduce_ex__(self, protocol: object) -> tuple[type[Status], tuple[int]]:
        """By value: early releases of Python 3.11 look members up by name, which an unknown one has no entry for."""
        del protocol
        return Status, (self.value,)

    @property
    def text(self) -> str:
        """The meaning of the status, in a few words without a full stop."""
        return _TEXTS.get(self.value, "status unknown to this package")


_TEXTS: Final[dict[int, str]] = {
    Status.OK: "done",
    Status.DATALOG_WRAPPED: "the datalog has overwritten its oldest entries",
    Status.PENDING: "communication still under way",
    Status.MAILBOX_EMPTY: "the mailbox is empty",
    Status.NO_MORE_HANDLES: "all file handles are in use",
    Status.NO_SPACE: "not enough free flash memory",
    Status.NO_MORE_FILES: "the file table is full",
    Status.END_OF_FILE_EXPECTED: "written past the declared size of the file",
    Status.END_OF_FILE: "read past the end of the file",
    Status.NOT_A_LINEAR_FILE: "the file is not stored in one piece",
    Status.FILE_NOT_FOUND: "file not found",
    Status.HANDLE_ALREADY_CLOSED: "the handle is already closed",
    Status.NO_LINEAR_SPACE: "no free flash memory in one piece for the file",
    Status.UNDEFINED_ERROR: "undefined error",
    Status.FILE_IS_BUSY: "the file is open elsewhere",
    Status.NO_WRITE_BUFFERS: "too many files are being written",
    Status.APPEND_NOT_POSSIBLE: "only data files can be appended to",
    Status.FILE_IS_FULL: "the file is full",
    Status.FILE_EXISTS: "a file of that name exists",
    Status.MODULE_NOT_FOUND: "module not found",
    Status.OUT_OF_BOUNDS: "outside the module's IO map",
    Status.ILLEGAL_FILE_NAME: "illegal file name",
    Status.ILLEGAL_HANDLE: "illegal handle",
    Status.BLUETOOTH_BUSY: "the radio is busy",
    Status.CONNECT_FAILED: "the Bluetooth connection failed",
    Status.BLUETOOTH_TIMEOUT: "the Bluetooth operation timed out",
    Status.TRANSFER_TIMEOUT: "the file transfer timed out",
    Status.TRANSFER_FILE_EXISTS: "the file to transfer exists at the destination",
    Status.TRANSFER_FILE_MISSING: "the file to transfer is missing at the source",
    Status.TRANSFER_STREAM_ERROR: "the stream of the file transfer broke",
    Status.TRANSFER_CLOSE_ERROR: "the file transfer could not be closed",
    Status.REQUEST_FAILED: "the request failed",
    Status.UNKNOWN_OPCODE: "the firmware does not know this command",
    Status.INSANE_PACKET: "the telegram makes no sense",
    Status.VALUE_OUT_OF_RANGE: "a value is out of range, or the file is missing",
    Status.BUS_ERROR: "the sensor does not answer on its bus",
    Status.BUFFER_FULL: "no room in the communication buffer",
    Status.CHANNEL_INVALID: "the communication channel is invalid",
    Status.CHANNEL_NOT_READY: "the sensor port is busy or not set up for a digital sensor",
    Status.NO_ACTIVE_PROGRAM: "no program is running",
    Status.ILLEGAL_SIZE: "illegal size",
    Status.ILLEGAL_MAILBOX: "no such mailbox",
    Status.INVALID_FIELD: "the structure has no such field",
    Status.BAD_PORT: "no such input or output",
    Status.BAD_POINTER: "bad pointer in the program",
    Status.NO_MEMORY: "not enough memory",
    Status.WRONG_VERSION: "the program is for another firmware version",
    Status.BAD_FILE: "the program file is damaged",
    Status.BAD_INSTRUCTION: "bad instruction in the program",
    Status.BAD_ARGUMENT: "bad argument",
}
