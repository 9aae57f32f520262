"""What every command declares: a request, the reply that belongs to it, the opcode and LEGO's name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Generic, TypeVar, final

from firmware_protocol.enums import TelegramType
from firmware_protocol.layout import WireStructure


class ReplyData(WireStructure):
    """Abstract: the data of a reply, behind ``02 opcode status``."""


@final
@dataclass(frozen=True)
class NoData(ReplyData):
    """A reply that ends with its status."""


ReplyT = TypeVar("ReplyT", bound=ReplyData)


class Command(WireStructure, Generic[ReplyT]):
    """Abstract: a request, behind ``type opcode``; its class is the command.

    Attributes:
        KIND: direct or system command.
        OPCODE: the telegram's second byte.
        NAME: LEGO's name of the command.
        Reply: the reply's data; `NoData` unless the command says otherwise.
    """

    KIND: ClassVar[TelegramType]
    OPCODE: ClassVar[int]
    NAME: ClassVar[str]
    Reply: ClassVar[type[ReplyData]] = NoData


class DirectCommand(Command[ReplyT]):
    """Abstract: a command that the running brick executes itself.

    Source: LEGO NXT firmware 1.29, c_cmd.c cCmdHandleRemoteCommands.
    """

    KIND = TelegramType.DIRECT

    def __init_subclass__(cls, *, opcode: int, name: str) -> None:
        super().__init_subclass__()
        cls.OPCODE = opcode
        cls.NAME = name


class SystemCommand(Command[ReplyT]):
    """Abstract: a command for files, modules and the brick's own settings.

    Source: LEGO NXT firmware 1.29, c_comm.c cCommInterpreteCmd and c_loader.c cLoaderFileRq.
    """

    KIND = TelegramType.SYSTEM

    def __init_subclass__(cls, *, opcode: int, name: str) -> None:
        super().__init_subclass__()
        cls.OPCODE = opcode
        cls.NAME = name
