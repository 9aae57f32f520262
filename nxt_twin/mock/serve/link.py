"""The mock brick in the same process: whole telegrams in and out, like any link to a brick."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

from firmware_protocol.usb import PACKET_SIZE
from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.serve.host import Host
from nxt_twin.mock.serve.profile import PROFILES, Profile

MakeFailure = Callable[[str], Exception]
"""Makes the exception to raise, from a message."""


@final
class MockLink:
    """A link to a mock brick by its USB way in.

    Args:
        host: the running brick; the brick lives on when the link is closed.
        profile: delays and faults.
        seed: of the jitter and the faults.
        late: makes the exception for "nothing came in time".
        lost: makes the exception for "the other end is gone".
    """

    def __init__(
        self,
        host: Host,
        profile: Profile = PROFILES["none"],
        *,
        seed: int = 0,
        late: MakeFailure = TimeoutError,
        lost: MakeFailure = ConnectionError,
    ) -> None:
        self._host = host
        self._line = host.connect(Transport.USB, profile, seed)
        self._late = late
        self._lost = lost
        self._open = host.take(self._line)

    def send(self, telegram: bytes) -> None:
        """Hand one telegram over, of at most 64 bytes."""
        self._check()
        self._host.catch_up()
        for at in range(0, len(telegram), PACKET_SIZE):
            self._line.write(telegram[at : at + PACKET_SIZE])

    def receive(self, timeout_s: float) -> bytes:
        """Wait for one telegram; with a timeout of 0, give only what is there already."""
        self._host.catch_up()
        deadline_s = self._host.clock.now_s() + timeout_s
        while True:
            reply = self._line.read()
            if reply is not None:
                return reply
            self._check()
            if self._host.clock.now_s() >= deadline_s:
                raise self._late(f"the mock brick sent nothing within {timeout_s:g} s")
            self._host.wait(deadline_s)

    def close(self) -> None:
        """Let go of the brick; closing again does nothing."""
        if self._open:
            self._open = False
            self._line.hang_up()
            self._host.release(self._line)

    def describe(self) -> str:
        """The link's name for a person."""
        return "mock: a brick made of software, in this process"

    def _check(self) -> None:
        if not self._open:
            raise self._lost("the link to the mock brick is closed, or another one is open")
        if not self._host.running:
            raise self._lost(f"the mock brick is {self._host.firmware.power.value}")
