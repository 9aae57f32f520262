"""How a link delays and damages what it carries."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, final


@final
@dataclass(frozen=True)
class Profile:
    """A link's behaviour; times in ms, probabilities for each byte.

    Attributes:
        to_brick_ms: from the host's writing to the firmware's receive buffer.
        to_host_ms: from the firmware's reply to the host.
        turnaround_ms: what a reply waits in addition, because the radio has to switch directions.
        jitter_ms: the most that is added, evenly distributed, either way.
        drop: that a byte is lost.
        corrupt: that a byte is changed.
    """

    to_brick_ms: float = 0.0
    to_host_ms: float = 0.0
    turnaround_ms: float = 0.0
    jitter_ms: float = 0.0
    drop: float = 0.0
    corrupt: float = 0.0

    @property
    def transparent(self) -> bool:
        """Whether it changes nothing at all."""
        return self == _TRANSPARENT


LinkProfile = Literal["none", "usb", "bluetooth"]

_TRANSPARENT: Final = Profile()

PROFILES: Final = MappingProxyType(
    {
        "none": _TRANSPARENT,
        "usb": Profile(to_brick_ms=0.2, to_host_ms=0.2, jitter_ms=0.8),
        "bluetooth": Profile(to_brick_ms=8.0, to_host_ms=4.0, turnaround_ms=22.0, jitter_ms=12.0),
    }
)
"""By name. A request with its reply takes 1 to 4 ms over USB and 30 to 60 ms over Bluetooth."""
