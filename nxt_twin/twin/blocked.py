"""A motor that was blocked one way and turns freely the other: it ran against something that stays where it is."""

from __future__ import annotations

from typing import NamedTuple, final

_BACK = 20
"""Counts by which it has to turn back: more than the play of its gear train."""


class _Block(NamedTuple):
    since_s: float
    at_count: int
    way: int


@final
class TurnedBack:
    """Watches a motor from when it was blocked until it turns on, or back."""

    def __init__(self) -> None:
        self._block: _Block | None = None

    def blocked(self, since_s: float, count: int, way: int) -> None:
        """It stands at a count since a moment, driven one way (1 or -1)."""
        self._block = _Block(since_s, count, way)

    def take(self, count: int) -> float | None:
        """Take a count; since when it was blocked, once, as soon as it has turned back from there."""
        if self._block is None:
            return None
        beyond = (count - self._block.at_count) * self._block.way
        if -_BACK < beyond < _BACK:
            return None
        block, self._block = self._block, None
        return block.since_s if beyond < 0 else None

    def clear(self) -> None:
        """Begin anew."""
        self._block = None
