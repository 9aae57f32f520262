"""Digital sensors, on the I2C bus that LEGO calls low speed: whole transactions and their three steps."""

from __future__ import annotations

from typing import Final, final

from firmware_protocol import (
    LowSpeedGetStatus,
    LowSpeedRead,
    LowSpeedWrite,
    SensorType,
    SetInputMode,
    Status,
)
from nxt_twin.brick.errors import CommandRefusedError, RequestError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped

RECEIVE_SIZE_MAX: Final = 15
"""The most bytes that one transaction can fetch: sixteen in the brick's ring look like none."""

_POLL_PERIOD_S: Final = 0.002
_SETTLE_S: Final = 0.1
"""How long a port may be "not ready": 20 ms after its type was set, or while a transaction ends."""
_TRANSACTION_S: Final = 0.5
"""Four attempts to reach a sensor, each of which the firmware gives up after 100 ms."""


@final
class LowSpeed:
    """The digital sensor ports of a brick; every method raises what `Exchange.put` does."""

    def __init__(self, exchange: Exchange) -> None:
        self._exchange = exchange

    def set_up(self, port: int, *, powered: bool = True) -> Stamped[None]:
        """A digital sensor is plugged in; `powered` gives it 9 V, as the ultrasonic sensor needs."""
        kind = SensorType.LOW_SPEED_9V if powered else SensorType.LOW_SPEED
        return self._exchange.ask(SetInputMode(port, kind, 0)).having(None)

    def status(self, port: int) -> Stamped[int]:
        """How many received bytes wait (LS_GET_STATUS); status PENDING while a transaction runs."""
        reply = self._exchange.ask(LowSpeedGetStatus(port))
        return reply.having(reply.value.bytes_ready)

    def write(self, port: int, data: bytes, *, receive_length: int = 0) -> Stamped[None]:
        """Start a transaction: send bytes, the sensor's address first, then receive (LS_WRITE)."""
        return self._exchange.ask(LowSpeedWrite.of(port, data, receive_length)).having(None)

    def read(self, port: int) -> Stamped[bytes]:
        """All received bytes (LS_READ)."""
        reply = self._exchange.ask(LowSpeedRead(port))
        return reply.having(reply.value.received)

    def transact(self, port: int, data: bytes, *, receive_length: int = 0) -> Stamped[bytes]:
        """A whole transaction: send, wait until it is over, fetch.

        Bytes that an earlier transaction left are dropped first: the firmware would put the new ones behind.

        Args:
            port: the sensor port, 0 to 3.
            data: what to send, at most 16 bytes, the sensor's address first.
            receive_length: how many bytes to fetch, at most 15.

        Returns:
            The bytes; sent when the transaction was started, received when they were fetched.

        Raises:
            RequestError: more than 15 bytes are to be fetched.
            CommandRefusedError: status BUS_ERROR: the sensor does not answer; CHANNEL_NOT_READY: the port is
                not set up for it.
        """
        if receive_length > RECEIVE_SIZE_MAX:
            raise RequestError(
                f"{receive_length} bytes cannot be fetched at once",
                where=f"sensor port {port + 1}",
                mend=f"fetch at most {RECEIVE_SIZE_MAX}, then the rest",
            )
        self._drop_leftovers(port)
        started = self._retry_write(port, data, receive_length)
        self._wait_until_over(port)
        if receive_length == 0:
            return started.having(b"")
        fetched = self.read(port)
        return Stamped(fetched.value, started.sent_s, fetched.received_s)

    def _drop_leftovers(self, port: int) -> None:
        try:
            if self.status(port).value:
                self.read(port)
        except CommandRefusedError as error:
            # An error of the last transaction ends with the next; a port that is not ready yet is waited for.
            if error.status not in (Status.BUS_ERROR, Status.CHANNEL_NOT_READY, Status.PENDING):
                raise

    def _retry_write(self, port: int, data: bytes, receive_length: int) -> Stamped[None]:
        clock = self._exchange.clock
        give_up_s = clock.now_s() + _SETTLE_S
        while True:
            try:
                return self.write(port, data, receive_length=receive_length)
            except CommandRefusedError as error:
                if error.status is not Status.CHANNEL_NOT_READY or clock.now_s() >= give_up_s:
                    raise
            clock.sleep(_POLL_PERIOD_S)

    def _wait_until_over(self, port: int) -> None:
        clock = self._exchange.clock
        give_up_s = clock.now_s() + _TRANSACTION_S
        while True:
            try:
                self.status(port)
            except CommandRefusedError as error:
                if error.status is not Status.PENDING or clock.now_s() >= give_up_s:
                    raise
            else:
                return
            clock.sleep(_POLL_PERIOD_S)
