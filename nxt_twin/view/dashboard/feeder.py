"""Hands messages to another process without ever making the one who hands them over wait."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from typing import IO, Final, final

from nxt_twin.twin.records import Event
from nxt_twin.view.dashboard.scene import Scenery
from nxt_twin.view.dashboard.wire import Message, line_of

CAPACITY: Final = 3000
"""Messages that wait at most: half a minute of polls at 100 Hz."""

_EVENTS: Final = 500
_END_S: Final = 0.5
_LOOK_S: Final = 0.04
"""The thread looks by itself for what has come: waking it would cost the loop more than handing over."""


@final
class Feeder:
    """A process of its own, a bounded queue, and a thread that carries from one to the other.

    `put` appends to the queue and returns. A full queue drops its oldest poll; events have room of their own, where the
    oldest event goes. The thread turns messages into lines and writes them to the process' standard input, where it
    may block for any time. Each line is short work, so the thread does not keep the interpreter from the loop.

    Args:
        command: starts the process; it has to end when its standard input does.
        patience_s: how long `close` waits for the process to take what is left, before it is ended.
        log: takes the process' standard error; None to discard it.
        capacity: of the queue, in messages.
        lossless: whether `put` waits for room instead; for replays, where nobody is kept waiting.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        patience_s: float,
        log: IO[bytes] | None,
        capacity: int = CAPACITY,
        lossless: bool = False,
    ) -> None:
        self._lossless = lossless
        self._patience_s = patience_s
        self._queue: deque[Message] = deque(maxlen=capacity)
        self._events: deque[Message] = deque(maxlen=_EVENTS)
        self._closing = threading.Event()
        self._gone = False
        self._dropped = 0
        self._told = 0
        # In a session of its own: an interrupt from the keyboard reaches the loop alone.
        self._process = subprocess.Popen(  # noqa: S603 - the command is ours
            list(command),
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL if log is None else log,
            bufsize=0,
            start_new_session=True,
        )
        self._thread = threading.Thread(target=self._carry, name="dashboard feeder", daemon=True)
        self._thread.start()

    @property
    def dropped(self) -> int:
        """Messages that went because the process did not keep up."""
        return self._dropped

    @property
    def waiting(self) -> int:
        """Messages that the process has not taken yet."""
        return len(self._queue) + len(self._events)

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process runs."""
        return self._process.poll() is None

    def put(self, message: Message) -> None:
        """Take a message; neither blocks (unless lossless) nor raises. Once the process is gone, it is forgotten."""
        queue = self._events if isinstance(message, Event | Scenery) else self._queue
        while self._lossless and len(queue) == queue.maxlen and not self._gone:
            self._closing.wait(_LOOK_S)
        if self._gone:
            return
        if len(queue) == queue.maxlen:
            self._dropped += 1
        queue.append(message)

    def finish(self) -> None:
        """Say that nothing more comes, without waiting."""
        self._closing.set()

    def close(self) -> int:
        """Wait until the process has ended, and end it where that takes too long.

        Returns:
            The process' exit status; negative where it had to be ended.
        """
        self.finish()
        try:
            status = self._process.wait(self._patience_s)
        except subprocess.TimeoutExpired:
            self._end()
            status = self._process.wait()
        if status < 0:
            # It had no chance to end what it started.
            self._end()
        self._thread.join(_END_S)
        return status

    def _end(self) -> None:
        """End the process and what it started that is to end with it."""
        if sys.platform == "win32":
            self._process.kill()
            return
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def _carry(self) -> None:
        pipe = self._process.stdin
        assert pipe is not None  # noqa: S101 - asked for above
        try:
            while True:
                closing = self._closing.wait(_LOOK_S)
                while self._events or self._queue:
                    if self._dropped > self._told:
                        lost, self._told = self._dropped - self._told, self._dropped
                        _write_all(pipe, line_of(lost))
                    _write_all(pipe, line_of((self._events or self._queue).popleft()))
                if closing:
                    return
        except OSError:
            return  # the process is gone, which its exit status tells
        finally:
            self._gone = True
            with suppress(OSError):
                pipe.close()
            self._queue.clear()
            self._events.clear()


def _write_all(pipe: IO[bytes], line: bytes) -> None:
    rest = memoryview(line)
    while rest:
        rest = rest[pipe.write(rest) or 0 :]
