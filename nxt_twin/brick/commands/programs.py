"""Programs on the brick: start, stop, ask which one runs."""

from __future__ import annotations

from typing import final

from firmware_protocol import GetCurrentProgram, StartProgram, Status, StopProgram
from nxt_twin.brick.errors import CommandRefusedError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped


@final
class Programs:
    """Starts and stops programs; every method raises what `Exchange.put` does.

    Leaving the brick does not stop a program, which may run motors of its own.
    """

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    def start(self, name: str) -> Stamped[None]:
        """Ask for a program to be started; the brick says only that the file exists, and starts it later."""
        return self._exchange.ask(StartProgram(name)).having(None)

    def stop(self) -> Stamped[None]:
        """Ask for the running program to be stopped, which happens after the reply."""
        return self._exchange.ask(StopProgram()).having(None)

    def current(self) -> Stamped[str | None]:
        """The running program's file name; None where none runs."""
        try:
            reply = self._exchange.ask(GetCurrentProgram())
        except CommandRefusedError as error:
            if error.status is not Status.NO_ACTIVE_PROGRAM:
                raise
            return Stamped(None, error.sent_s, error.received_s)
        return reply.having(reply.value.name)
