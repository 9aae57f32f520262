"""Since when a motor has been off its model, where it seems to be on it again for a while in between."""

from __future__ import annotations

from typing import final

from nxt_twin.recording.columns import Port

BRIDGED_S = 20.0
"""A shorter peace does not end it: a program may leave out for so long what shows the difference."""


@final
class Apart:
    """Remembers, for each motor, when the present divergence began."""

    def __init__(self) -> None:
        self._since_s: dict[Port, float] = {}
        self._until_s: dict[Port, float] = {}

    def since(self, port: Port, onset_s: float, now_s: float) -> float:
        """Take that a motor is off its model now, since `onset_s`; when that began, peaces bridged."""
        if now_s - self._until_s.get(port, -BRIDGED_S) >= BRIDGED_S:
            self._since_s[port] = onset_s
        self._until_s[port] = now_s
        return self._since_s[port]

    def forget(self, port: Port) -> None:
        """Whatever comes is another divergence: the model has become another, or the brick was away."""
        self._until_s.pop(port, None)
