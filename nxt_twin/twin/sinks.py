"""Sinks that a session cannot be held up by."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from typing import final

from nxt_twin.twin.records import Event, Sink, Tick


@final
class Memory:
    """Keeps what a session said; of the polls only the last ones.

    Args:
        ticks: how many polls to keep.

    Attributes:
        ticks: the last polls.
        events: every event.
        count: how many polls there were.
    """

    def __init__(self, ticks: int = 1000) -> None:
        self.ticks: deque[Tick] = deque(maxlen=ticks)
        self.events: list[Event] = []
        self.count = 0

    def tick(self, tick: Tick) -> None:
        """Keep a poll."""
        self.ticks.append(tick)
        self.count += 1

    def event(self, event: Event) -> None:
        """Keep an event."""
        self.events.append(event)

    def close(self) -> None:
        """Nothing to finish."""


@final
class Several:
    """Tells several sinks; one that fails is left out from then on.

    Args:
        sinks: in the order in which they are told.
    """

    def __init__(self, sinks: Sequence[Sink]) -> None:
        self._sinks = list(sinks)

    def tick(self, tick: Tick) -> None:
        """Tell all of a poll."""
        for sink in list(self._sinks):
            try:
                sink.tick(tick)
            except Exception:  # whatever a viewer does wrong, the brick has to be watched on
                self._sinks.remove(sink)

    def event(self, event: Event) -> None:
        """Tell all of an event."""
        for sink in list(self._sinks):
            try:
                sink.event(event)
            except Exception:
                self._sinks.remove(sink)

    def close(self) -> None:
        """Close all."""
        for sink in self._sinks:
            with suppress(Exception):
                sink.close()
