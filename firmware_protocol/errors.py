"""Every failure of the wire language, as one tree.

    ProtocolError
    ├── TelegramError              bytes that are not the telegram they should be
    │   ├── TelegramTooShortError      they end before the last field does
    │   ├── TrailingBytesError         they go on after the last field
    │   ├── TelegramTypeError          the first byte announces another kind of telegram
    │   └── OpcodeError                the second byte is unassigned, or another command's
    ├── FrameTooLongError          a Bluetooth length prefix announces more than the reader accepts
    ├── FieldValueError            a value that does not fit its field
    ├── FieldPathError             a declaration has no field of that name
    └── BrickStatusError           the brick answered, with a status other than OK
        ├── NotYetError                nothing is wrong, ask again later
        │   ├── PendingError               20
        │   └── MailboxEmptyError          40
        ├── DatalogWrappedError        10
        ├── NoProgramError             EC
        ├── UnknownCommandError        BE BF
        ├── BadArgumentError           C0 ED EE EF F0 FF
        ├── LowSpeedError              a digital sensor's bus: DD DE DF E0
        ├── LoaderError                files, handles and modules: 8A
        │   ├── FileMissingError           87
        │   ├── FileExistsOnBrickError     8F
        │   ├── FileBusyError              8B
        │   ├── FileKindError              86 8D
        │   ├── IllegalFileNameError       92
        │   ├── HandleError                81 88 8C 93
        │   ├── NoSpaceError               82 83 89 8E
        │   ├── EndOfFileError             84 85
        │   └── ModuleError                90 91
        ├── RadioError                 94 to 9B
        └── ProgramFaultError          BD FA to FE

A status that the firmware does not define is a plain BrickStatusError.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from firmware_protocol.status import Status


class ProtocolError(Exception):
    """Any failure of this package."""


class TelegramError(ProtocolError):
    """Bytes that are not the telegram they should be."""


class TelegramTooShortError(TelegramError):
    """The bytes end before the last field does."""


class TrailingBytesError(TelegramError):
    """The bytes go on after the last field."""


class TelegramTypeError(TelegramError):
    """The first byte announces another kind of telegram."""


class OpcodeError(TelegramError):
    """The second byte is unassigned, or it is another command's."""


class FrameTooLongError(ProtocolError):
    """A Bluetooth length prefix announces more than the reader accepts, or a telegram does not fit one."""


class FieldValueError(ProtocolError):
    """A value that does not fit its field on the wire."""


class FieldPathError(ProtocolError):
    """A declaration has no field of that name."""


class BrickStatusError(ProtocolError):
    """The brick answered with a status other than OK.

    Args:
        status: the status byte of the reply.
        command: LEGO's name of the command, if one was sent.
        detail: what is special about this case.
        reply: the reply's data, where the brick sent all of it in spite of the status (a short READ).
    """

    def __init__(self, status: Status, *, command: str = "", detail: str = "", reply: object = None) -> None:
        self.status = status
        self.command = command
        self.detail = detail
        self.reply = reply
        place = f"{command}: " if command else ""
        more = f": {detail}" if detail else ""
        super().__init__(f"{place}{status.text} (status 0x{status:02X}){more}")


class NotYetError(BrickStatusError):
    """Nothing is wrong, only nothing is there yet: ask again later."""


class PendingError(NotYetError):
    """A digital sensor's transaction is still under way."""


class MailboxEmptyError(NotYetError):
    """The mailbox holds no message."""


class DatalogWrappedError(BrickStatusError):
    """The datalog has overwritten its oldest entries; the data in ``reply`` are good."""


class NoProgramError(BrickStatusError):
    """The command needs a running program; mailboxes, too, exist only while one runs."""


class UnknownCommandError(BrickStatusError):
    """The firmware does not know the command."""


class BadArgumentError(BrickStatusError):
    """An argument is out of range: a port, a size, a mailbox, or the name of a file that is not there."""


class LowSpeedError(BrickStatusError):
    """A digital sensor does not answer, or its port is not ready."""


class LoaderError(BrickStatusError):
    """A file, handle or module operation failed."""


class FileMissingError(LoaderError):
    """The brick has no file that fits the name or pattern."""


class FileExistsOnBrickError(LoaderError):
    """A file of that name exists already."""


class FileBusyError(LoaderError):
    """The file is open elsewhere."""


class FileKindError(LoaderError):
    """The file is of a kind that does not allow the operation."""


class IllegalFileNameError(LoaderError):
    """The file name is too long, or not allowed for that kind of file."""


class HandleError(LoaderError):
    """No handle or write buffer is free, or the handle is not open for the operation."""


class NoSpaceError(LoaderError):
    """No room is left: flash memory, file table, or the file itself."""


class EndOfFileError(LoaderError):
    """Read or written past the end of the file; ``reply`` holds what went through."""


class ModuleError(LoaderError):
    """No such module, or the range lies outside its IO map."""


class RadioError(BrickStatusError):
    """The Bluetooth radio is busy, or a connection or transfer failed."""


class ProgramFaultError(BrickStatusError):
    """The virtual machine, or the program that it runs, failed."""


_STATUSES_BY_ERROR: Final[dict[type[BrickStatusError], tuple[Status, ...]]] = {
    PendingError: (Status.PENDING,),
    MailboxEmptyError: (Status.MAILBOX_EMPTY,),
    DatalogWrappedError: (Status.DATALOG_WRAPPED,),
    NoProgramError: (Status.NO_ACTIVE_PROGRAM,),
    UnknownCommandError: (Status.UNKNOWN_OPCODE, Status.INSANE_PACKET),
    BadArgumentError: (
        Status.VALUE_OUT_OF_RANGE,
        Status.ILLEGAL_SIZE,
        Status.ILLEGAL_MAILBOX,
        Status.INVALID_FIELD,
        Status.BAD_PORT,
        Status.BAD_ARGUMENT,
    ),
    LowSpeedError: (Status.BUS_ERROR, Status.BUFFER_FULL, Status.CHANNEL_INVALID, Status.CHANNEL_NOT_READY),
    LoaderError: (Status.UNDEFINED_ERROR,),
    FileMissingError: (Status.FILE_NOT_FOUND,),
    FileExistsOnBrickError: (Status.FILE_EXISTS,),
    FileBusyError: (Status.FILE_IS_BUSY,),
    FileKindError: (Status.NOT_A_LINEAR_FILE, Status.APPEND_NOT_POSSIBLE),
    IllegalFileNameError: (Status.ILLEGAL_FILE_NAME,),
    HandleError: (
        Status.NO_MORE_HANDLES,
        Status.HANDLE_ALREADY_CLOSED,
        Status.NO_WRITE_BUFFERS,
        Status.ILLEGAL_HANDLE,
    ),
    NoSpaceError: (Status.NO_SPACE, Status.NO_MORE_FILES, Status.NO_LINEAR_SPACE, Status.FILE_IS_FULL),
    EndOfFileError: (Status.END_OF_FILE_EXPECTED, Status.END_OF_FILE),
    ModuleError: (Status.MODULE_NOT_FOUND, Status.OUT_OF_BOUNDS),
    RadioError: (
        Status.BLUETOOTH_BUSY,
        Status.CONNECT_FAILED,
        Status.BLUETOOTH_TIMEOUT,
        Status.TRANSFER_TIMEOUT,
        Status.TRANSFER_FILE_EXISTS,
        Status.TRANSFER_FILE_MISSING,
        Status.TRANSFER_STREAM_ERROR,
        Status.TRANSFER_CLOSE_ERROR,
    ),
    ProgramFaultError: (
        Status.REQUEST_FAILED,
        Status.BAD_POINTER,
        Status.NO_MEMORY,
        Status.WRONG_VERSION,
        Status.BAD_FILE,
        Status.BAD_INSTRUCTION,
    ),
}
_ERROR_BY_STATUS: Final = MappingProxyType(
    {status: error for error, statuses in _STATUSES_BY_ERROR.items() for status in statuses}
)


def status_error(status: Status, *, command: str = "", reply: object = None) -> BrickStatusError:
    """The error of the class that the status belongs to, to be raised by the caller.

    Args:
        status: a status other than OK.
        command: LEGO's name of the command that was answered.
        reply: the reply's data, if the brick sent all of it.
    """
    error = _ERROR_BY_STATUS.get(status, BrickStatusError)
    return error(status, command=command, reply=reply)
