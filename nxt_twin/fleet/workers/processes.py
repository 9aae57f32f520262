"""Tasks in processes of this machine. A process may be killed at any moment: that costs time, and no result."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any, Final, Generic, cast, final

from nxt_twin.fleet.workers.outcome import (
    MOST_DEATHS,
    CaseOutcome,
    Failure,
    ResultT,
    TaskT,
    died,
    raised,
)
from nxt_twin.threads import ask_for_one_thread, one_of_many

# Compiled kernels and threads do not survive a fork.
_CONTEXT: Final = get_context("spawn")


def in_processes(
    work: Callable[[TaskT], ResultT], tasks: Iterable[TaskT], count: int
) -> Iterator[CaseOutcome[TaskT, ResultT]]:
    """Yield the outcome of `work(task)` for each task, in the order in which they end, from `count` processes.

    A task whose process died is given to another one, until `MOST_DEATHS` have died over it.
    """
    crew = _Crew(work, iter(tasks), count)
    try:
        while crew.busy():
            yield from crew.ended()
    finally:
        crew.close()


@final
class _Crew(Generic[TaskT, ResultT]):
    """Workers, each with at most one task; a task has a number of workers that died over it."""

    def __init__(self, work: Callable[[TaskT], ResultT], tasks: Iterator[TaskT], count: int) -> None:
        self._work = work
        self._tasks = tasks
        self._count = count
        self._again: deque[tuple[TaskT, int]] = deque()
        self._at_work: dict[Connection, tuple[_Worker, TaskT, int]] = {}
        self._idle: list[_Worker] = []

    def busy(self) -> bool:
        """Give tasks to whoever is free; whether anybody is at work then."""
        given = []
        while len(self._at_work) < self._count and (drawn := self._drawn()):
            worker = self._idle.pop() if self._idle else _Worker(self._work)
            self._at_work[worker.pipe] = (worker, *drawn)
            given.append((worker.pipe, drawn[0]))
        for pipe, task in given:  # all have started by now: a large task waits until it is taken
            with suppress(OSError):  # it has died: waiting for its answer tells so
                pipe.send(task)
        return bool(self._at_work)

    def ended(self) -> Iterator[CaseOutcome[TaskT, ResultT]]:
        """Wait for somebody, and yield what became of the tasks that have ended."""
        for pipe in wait(list(self._at_work)):
            worker, task, deaths = self._at_work.pop(cast("Connection", pipe))
            try:
                result, failure = worker.pipe.recv()
            except (EOFError, OSError):
                worker.kill()
                if deaths + 1 < MOST_DEATHS:
                    self._again.append((task, deaths + 1))
                else:
                    yield CaseOutcome(task, None, died())
                continue
            self._idle.append(worker)
            yield CaseOutcome(task, result, failure)

    def close(self) -> None:
        """End all, whatever they do."""
        for worker in (*self._idle, *(worker for worker, _, _ in self._at_work.values())):
            worker.kill()

    def _drawn(self) -> tuple[TaskT, int] | None:
        if self._again:
            return self._again.popleft()
        return next(((task, 0) for task in self._tasks), None)


@final
class _Worker:
    """A process that answers each task over a pipe."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        self.pipe, theirs = _CONTEXT.Pipe()
        ask_for_one_thread()  # a process inherits it, and imports numpy before anything of ours runs
        self._process = _CONTEXT.Process(target=_serve, args=(theirs, work), daemon=True)
        self._process.start()
        theirs.close()

    def kill(self) -> None:
        """End it, and wait until it has."""
        self._process.kill()
        self._process.join()
        self.pipe.close()


def _serve(pipe: Connection, work: Callable[[Any], Any]) -> None:
    """Answer tasks until nobody asks; an interrupt at the terminal is for who asks."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(EOFError, OSError):
        while True:
            pipe.send(_answer(work, pipe.recv()))


def _answer(work: Callable[[Any], Any], task: object) -> tuple[object, Failure | None]:
    try:
        with one_of_many():
            return work(task), None
    except Exception as error:
        return None, raised(error)
