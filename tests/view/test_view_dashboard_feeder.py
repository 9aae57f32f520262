"""Whoever hands polls over never waits, whatever becomes of the process that takes them."""

from __future__ import annotations

import sys
import tempfile
from typing import IO

from view_ticks import some_events, some_ticks

from nxt_twin.twin.records import Event, Tick
from nxt_twin.view.dashboard.feeder import Feeder
from nxt_twin.view.dashboard.wire import read

_COPIES = "import shutil, sys; shutil.copyfileobj(sys.stdin.buffer, sys.stderr.buffer)"
_NEVER_READS = "import time; time.sleep(600)"
_DIES = "raise SystemExit(3)"


def _feeder(code: str, log: IO[bytes] | None, capacity: int = 3000, patience_s: float = 60.0) -> Feeder:
    return Feeder([sys.executable, "-c", code], patience_s=patience_s, log=log, capacity=capacity)


def test_everything_arrives_in_order_and_the_process_ends():
    ticks, events = some_ticks(400), some_events()
    with tempfile.TemporaryFile() as log:
        feeder = _feeder(_COPIES, log)
        for message in (*ticks, *events):
            feeder.put(message)
        assert feeder.close() == 0
        log.seek(0)
        messages = [read(line) for line in log]
    assert [message for message in messages if isinstance(message, Tick)] == ticks
    assert [message for message in messages if isinstance(message, Event)] == events
    assert feeder.dropped == 0
    assert feeder.waiting == 0


def test_a_process_that_never_reads_loses_the_oldest_polls_only():
    feeder = _feeder(_NEVER_READS, None, capacity=50, patience_s=0.2)
    for tick in some_ticks(2000):
        feeder.put(tick)
    # Some polls fit into the pipe between the two processes; the queue holds 50 of the others.
    assert feeder.waiting <= 50
    assert 1000 < feeder.dropped < 2000
    assert feeder.close() < 0
    assert not feeder.alive


def test_losses_are_told_to_the_process():
    ticks = some_ticks(3000)
    slow = "import time; time.sleep(1.0); " + _COPIES
    with tempfile.TemporaryFile() as log:
        feeder = _feeder(slow, log, capacity=20)
        for tick in ticks:
            feeder.put(tick)
        assert feeder.close() == 0
        log.seek(0)
        messages = [read(line) for line in log]
    told = sum(message for message in messages if isinstance(message, int))
    arrived = [message for message in messages if isinstance(message, Tick)]
    assert told == feeder.dropped > 0
    assert len(arrived) + told == len(ticks)
    assert arrived[-1] == ticks[-1]


def test_events_have_room_of_their_own():
    event = some_events()[1]
    with tempfile.TemporaryFile() as log:
        feeder = _feeder("import time; time.sleep(0.5); " + _COPIES, log, capacity=20)
        feeder.put(event)
        for tick in some_ticks(2000):
            feeder.put(tick)
        assert feeder.close() == 0
        log.seek(0)
        assert event in [read(line) for line in log]


def test_a_process_that_dies_costs_nothing():
    feeder = _feeder(_DIES, None)
    for tick in some_ticks(1000):
        feeder.put(tick)
    assert feeder.close() == 3
    feeder.put(some_ticks(1)[0])
    assert feeder.waiting == 0
    assert feeder.close() == 3


def test_a_replay_waits_and_loses_nothing():
    ticks = some_ticks(200)
    with tempfile.TemporaryFile() as log:
        feeder = Feeder([sys.executable, "-c", _COPIES], patience_s=60.0, log=log, capacity=10, lossless=True)
        for tick in ticks:
            feeder.put(tick)
        assert feeder.close() == 0
        log.seek(0)
        assert [read(line) for line in log] == ticks
    assert feeder.dropped == 0


def test_a_replay_does_not_wait_for_a_process_that_died():
    feeder = Feeder([sys.executable, "-c", _DIES], patience_s=60.0, log=None, capacity=10, lossless=True)
    for tick in some_ticks(300):
        feeder.put(tick)
    assert feeder.close() == 3
