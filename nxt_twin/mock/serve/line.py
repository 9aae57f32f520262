"""A host's connection to the firmware, with the delays and faults of its profile."""

from __future__ import annotations

from collections import deque
from random import Random
from typing import NamedTuple, final

from nxt_twin.mock.firmware.channel import Transport
from nxt_twin.mock.firmware.firmware import Firmware
from nxt_twin.mock.serve.profile import Profile


class _Parcel(NamedTuple):
    due_ms: float
    data: bytes


@final
class Line:
    """Carries bytes both ways, in order; time is the firmware's.

    Args:
        firmware: the brick; another one takes its place when the brick is switched on again.
        transport: which of its two ways in.
        profile: delays and faults.
        seed: of the jitter and the faults.
    """

    def __init__(self, firmware: Firmware, transport: Transport, profile: Profile, seed: int = 0) -> None:
        self.profile = profile
        self.transport = transport
        self.firmware = firmware
        self._random = Random(seed)  # noqa: S311 - faults, not secrets
        self._to_brick: deque[_Parcel] = deque()
        self._to_host: deque[_Parcel] = deque()

    def write(self, data: bytes) -> None:
        """The host sends bytes; over USB a whole packet."""
        self._put(self._to_brick, data, self.profile.to_brick_ms)

    def deliver(self) -> None:
        """Before a tick: give the firmware what has arrived by now."""
        while self._to_brick and self._to_brick[0].due_ms <= self.firmware.ticks:
            self.firmware.receive(self.transport, self._to_brick.popleft().data)

    def collect(self) -> None:
        """After a tick: take the firmware's replies."""
        for reply in self.firmware.transmit(self.transport):
            self._put(self._to_host, reply, self.profile.to_host_ms + self.profile.turnaround_ms)

    def read(self) -> bytes | None:
        """The next reply that has reached the host: one packet, or one frame; None if there is none."""
        if self._to_host and self._to_host[0].due_ms <= self.firmware.ticks:
            return self._to_host.popleft().data
        return None

    def hang_up(self) -> None:
        """The host is gone, or the cable: what is on its way is lost."""
        self._to_brick.clear()
        self._to_host.clear()
        if self.transport is Transport.USB:
            self.firmware.unplug_usb()
        else:
            self.firmware.disconnect_bluetooth()

    def reset(self) -> None:
        """Forget what is on its way, without hanging up."""
        self._to_brick.clear()
        self._to_host.clear()

    def _put(self, queue: deque[_Parcel], data: bytes, delay_ms: float) -> None:
        profile = self.profile
        if profile.transparent:
            queue.append(_Parcel(self.firmware.ticks, data))
            return
        due_ms = self.firmware.ticks + delay_ms + self._random.random() * profile.jitter_ms
        if queue:
            due_ms = max(due_ms, queue[-1].due_ms)
        if profile.drop or profile.corrupt:
            data = self._damage(data)
        if data:
            queue.append(_Parcel(due_ms, data))

    def _damage(self, data: bytes) -> bytes:
        kept = bytearray()
        for byte in data:
            if self._random.random() < self.profile.drop:
                continue
            corrupt = self._random.random() < self.profile.corrupt
            kept.append(byte ^ self._random.randint(1, 0xFF) if corrupt else byte)
        return bytes(kept)
