"""The ultrasonic sensor: distance, echoes of a single shot, and any of its registers."""

from __future__ import annotations

from typing import Final, final

from firmware_protocol.ultrasonic import ADDRESS, ECHO_COUNT, UltrasonicCommand, UltrasonicRegister
from nxt_twin.brick.commands.low_speed import LowSpeed
from nxt_twin.brick.errors import GarbageError
from nxt_twin.brick.exchange import Exchange
from nxt_twin.brick.stamped import Stamped

_REST_S: Final = 0.015
"""The pause that the sensor needs between transactions (LEGO hardware developer kit, appendix 7)."""


@final
class Ultrasonic:
    """Ultrasonic sensors on any sensor port; every method raises what `LowSpeed.transact` does."""

    def __init__(self, exchange: Exchange, low_speed: LowSpeed) -> None:
        self._exchange = exchange
        self._low_speed = low_speed
        self._rested_s: dict[int, float] = {}

    def set_up(self, port: int) -> Stamped[None]:
        """An ultrasonic sensor is plugged in; it wakes up measuring continuously."""
        return self._low_speed.set_up(port, powered=True)

    def distance_cm(self, port: int) -> Stamped[int]:
        """The distance byte, cm; 255 where nothing came back (`firmware_protocol.ultrasonic.NO_ECHO`)."""
        reply = self.read_register(port, UltrasonicRegister.MEASUREMENT)
        return reply.having(reply.value[0])

    def echoes_cm(self, port: int) -> Stamped[tuple[int, ...]]:
        """The eight distance bytes of the last single shot, nearest first; 255 where there was no echo."""
        reply = self.read_register(port, UltrasonicRegister.MEASUREMENT, ECHO_COUNT)
        return reply.having(tuple(reply.value))

    def command(self, port: int, command: UltrasonicCommand) -> Stamped[None]:
        """Tell the sensor how to measure."""
        return self.write_register(port, UltrasonicRegister.COMMAND, command)

    def read_register(self, port: int, register: int, length: int = 1) -> Stamped[bytes]:
        """The bytes from a register on, at most 15.

        Raises:
            GarbageError: the brick fetched another number of bytes.
        """
        reply = self._transact(port, bytes((ADDRESS, register)), length)
        if len(reply.value) != length:
            raise GarbageError(
                f"the sensor gave {len(reply.value)} bytes instead of {length}",
                where=f"sensor port {port + 1}",
            )
        return reply

    def write_register(self, port: int, register: int, value: int) -> Stamped[None]:
        """Set a one-byte register."""
        return self._transact(port, bytes((ADDRESS, register, value)), 0).having(None)

    def _transact(self, port: int, data: bytes, length: int) -> Stamped[bytes]:
        clock = self._exchange.clock
        wait_s = self._rested_s.get(port, 0.0) - clock.now_s()
        if wait_s > 0:
            clock.sleep(wait_s)
        try:
            return self._low_speed.transact(port, data, receive_length=length)
        finally:
            self._rested_s[port] = clock.now_s() + _REST_S
