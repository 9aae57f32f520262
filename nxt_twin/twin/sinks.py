"""Sinks that a session cannot be held up by."""

from __future__ import annotations

import queue
import threading
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
class Aside:
    """Feeds a slow sink from a thread of its own; what it cannot take in time is dropped, events last.

    Args:
        sink: the slow one; used by that thread alone.
        room: how many records may wait.
        patience_s: how long closing waits for it.

    Attributes:
        dropped: how many polls it missed.
    """

    def __init__(self, sink: Sink, room: int = 2000, patience_s: float = 2.0) -> None:
        self._sink = sink
        self._waiting: queue.Queue[Tick | Event | None] = queue.Queue(room)
        self._patience_s = patience_s
        self.dropped = 0
        self._thread = threading.Thread(target=self._work, name="sink", daemon=True)
        self._thread.start()

    def tick(self, tick: Tick) -> None:
        """Hand a poll over, or drop it."""
        try:
            self._waiting.put_nowait(tick)
        except queue.Full:
            self.dropped += 1

    def event(self, event: Event) -> None:
        """Hand an event over, in place of the oldest record if need be."""
        while True:
            try:
                self._waiting.put_nowait(event)
            except queue.Full:
                with suppress(queue.Empty):
                    self._waiting.get_nowait()
                    self.dropped += 1
            else:
                return

    def close(self) -> None:
        """Let it finish, but not for ever."""
        with suppress(queue.Full):
            self._waiting.put(None, timeout=self._patience_s)
        self._thread.join(self._patience_s)

    def _work(self) -> None:
        while (record := self._waiting.get()) is not None:
            with suppress(Exception):  # a sink that fails must not end the session; the next record may do
                if isinstance(record, Tick):
                    self._sink.tick(record)
                else:
                    self._sink.event(record)
        with suppress(Exception):
            self._sink.close()


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
