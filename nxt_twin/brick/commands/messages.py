"""Mailboxes of the program that runs on the brick, and its datalog."""

from __future__ import annotations

from typing import final

from firmware_protocol import DatalogRead, DatalogSetTimes, MessageRead, MessageWrite
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped


@final
class Messages:
    """Messages between a host and a brick's program; every method raises what `Exchange.put` does.

    Mailboxes exist only while a program runs (status NO_ACTIVE_PROGRAM) and keep five messages each.
    """

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    def write(self, mailbox: int, message: bytes) -> Stamped[None]:
        """Put a message of at most 58 bytes into a mailbox (0 to 9 are for the program to read)."""
        return self._exchange.ask(MessageWrite.of(mailbox, message)).having(None)

    def read(self, mailbox: int, *, local_mailbox: int = 0, remove: bool = True) -> Stamped[bytes]:
        """The oldest message of a mailbox (10 to 19 are for the program to write); status MAILBOX_EMPTY.

        Args:
            mailbox: the brick's.
            local_mailbox: a number that the reply repeats.
            remove: whether to take it out, or only to look at it.
        """
        reply = self._exchange.ask(MessageRead(mailbox, local_mailbox, remove))
        return reply.having(reply.value.message)

    def read_datalog(self, *, remove: bool = True) -> Stamped[bytes]:
        """The oldest entry of the program's datalog."""
        reply = self._exchange.ask(DatalogRead(remove))
        return reply.having(reply.value.entry)

    def set_datalog_time(self, time: int) -> Stamped[None]:
        """Set the datalog's clock."""
        return self._exchange.ask(DatalogSetTimes(time)).having(None)
