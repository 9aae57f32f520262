"""Every failure between here and a brick, as one tree.

NxtTwinError
└── BrickError
    ├── LinkError                the way to the brick
    │   ├── LinkUrlError             a URL that is not one
    │   ├── LinkRefusedError         the link cannot be opened; its `cause` says why (`Refusal`)
    │   ├── LinkLostError            it was open and is gone: unplugged, switched off, out of reach
    │   ├── LinkTimeoutError         nothing came in time
    │   │   └── HalfTelegramError        the start of a telegram came, and no more of it
    │   └── GarbageError             something came that is not the answer to anything
    ├── RequestError             a request that cannot be sent: a value does not fit its field
    └── CommandRefusedError      the brick answered, with a status other than OK
"""

from __future__ import annotations

from enum import StrEnum
from types import MappingProxyType
from typing import Final

from firmware_protocol import BrickStatusError, Status
from nxt_twin.errors import NxtTwinError


class Refusal(StrEnum):
    """Why a link cannot be opened."""

    NO_PERMISSION = "no_permission"
    BUSY = "busy"
    NO_DRIVER = "no_driver"
    NO_ADAPTER = "no_adapter"
    NOT_FOUND = "not_found"
    UNREACHABLE = "unreachable"
    BOOT_MODE = "boot_mode"
    OTHER_FIRMWARE = "other_firmware"


class BrickError(NxtTwinError):
    """Something between here and a brick, or the brick itself, does not do what was asked."""


class LinkError(BrickError):
    """The way to the brick."""


class LinkUrlError(LinkError):
    """A URL with an unknown scheme, or an address that the scheme cannot read."""


class LinkRefusedError(LinkError):
    """The link cannot be opened.

    Args:
        what: what is wrong.
        cause: the kind of obstacle.
        where: the URL or device.
        mend: what to do about it.
    """

    def __init__(self, what: str, *, cause: Refusal, where: str = "", mend: str = "") -> None:
        super().__init__(what, where=where, mend=mend)
        self.cause = cause


class LinkLostError(LinkError):
    """The link was open and is gone; open a new one."""


class LinkTimeoutError(LinkError):
    """Nothing came in time. The link may still be good: the next request is told from late replies."""


class HalfTelegramError(LinkTimeoutError):
    """The start of a telegram came, and no more of it in time; what came is dropped."""


class GarbageError(LinkError):
    """Something came that no brick sends, or a reply that is broken; what came is dropped."""


class RequestError(BrickError):
    """A request that cannot be sent: a value does not fit its field, or the telegram not the link."""


class CommandRefusedError(BrickError):
    """The brick answered, with a status other than OK.

    Args:
        error: the wire language's error; its class tells the kind.
        sent_s: the clock just before the request was sent, s.
        received_s: the clock just after the reply was received, s.

    Attributes:
        status: the status byte of the reply.
        reply: the reply's data, where the brick sent them in spite of the status.
    """

    def __init__(self, error: BrickStatusError, *, sent_s: float, received_s: float) -> None:
        super().__init__(str(error), mend=_MENDS.get(error.status, ""))
        self.status = error.status
        self.reply = error.reply
        self.sent_s = sent_s
        self.received_s = received_s


_MENDS: Final = MappingProxyType(
    {
        Status.BLUETOOTH_BUSY: "another client is connected to the brick, or its radio is busy: try again",
        Status.NO_ACTIVE_PROGRAM: "mailboxes and datalog need a program that runs on the brick",
        Status.BUS_ERROR: "check the sensor's cable and port",
        Status.CHANNEL_NOT_READY: "set the port to a digital sensor's type, and wait 20 ms",
        Status.NO_SPACE: "delete files on the brick",
        Status.NO_LINEAR_SPACE: "delete files on the brick",
        Status.FILE_EXISTS: "delete the file first, or write with replace",
        Status.NO_MORE_HANDLES: "switch the brick off and on: an earlier program left its files open",
        Status.UNKNOWN_OPCODE: "this brick's firmware lacks the command",
    }
)
