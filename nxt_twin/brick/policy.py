"""How long to wait and how much to send at once, which differs from link to link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

from firmware_protocol import bluetooth, usb


@final
@dataclass(frozen=True)
class Policy:
    """The rules of an `Exchange`: timeouts and retries.

    Attributes:
        reply_timeout_s: how long a reply may take.
        telegram_size: the longest telegram, either way, bytes.
        keep_alive_period_s: how often a brick that is talked to is told not to fall asleep; None for never.
            The shortest sleep timeout in the brick's menu is 2 min, and other commands do not put it off.
        release_timeout_s: how long to wait, at the end, for the brick to confirm that its motors coast.
    """

    reply_timeout_s: float = 1.0
    telegram_size: int = usb.PACKET_SIZE
    keep_alive_period_s: float | None = 60.0
    release_timeout_s: float = 0.3


PACKET_POLICY: Final = Policy()
"""USB: one telegram a packet."""

STREAM_POLICY: Final = Policy(
    reply_timeout_s=2.0, telegram_size=bluetooth.RECEIVE_BUFFER_SIZE, release_timeout_s=1.0
)
"""Bluetooth and what is framed like it: the radio may stall for a second without being lost."""
