"""When a demonstration has shown all."""

from __future__ import annotations

import math
from typing import final

from nxt_twin.twin.records import Event, Tick

_SHOWN_S = 3.0
"""How much longer one sees that the divergence is gone."""


@final
class Ending:
    """A sink that knows whether what was found has been taken over, and the divergence is gone for a while."""

    def __init__(self) -> None:
        self._gone_s = math.inf
        self._now_s = 0.0
        self._adopted = False

    def enough(self) -> bool:
        """Whether all has been shown."""
        return self._now_s >= self._gone_s + _SHOWN_S

    def tick(self, tick: Tick) -> None:
        """Time passes."""
        self._now_s = tick.received_s

    def event(self, event: Event) -> None:
        """Something happened."""
        self._adopted = self._adopted or event.kind == "adopted"
        if event.kind == "divergence":
            self._gone_s = math.inf
        elif event.kind == "calm" and self._adopted:
            self._gone_s = event.time_s

    def close(self) -> None:
        """Nothing to finish."""
