"""Work beside a session that the session's end does not wait for."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, TypeVar, final

T = TypeVar("T")

_PATIENT = 5


@final
class Beside(Executor):
    """Does each thing in a thread of its own, which the end of the program does not wait for.

    The library's executors do wait: after Ctrl-C a program would stay until a diagnosis that nobody wants is done.

    Args:
        name: of the threads.
        first: done at a thread's beginning.
    """

    def __init__(self, name: str, first: Callable[[], None] = lambda: None) -> None:
        self._name, self._first = name, first

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:  # noqa: ANN401
        """Begin it, and give what will come of it."""
        future: Future[T] = Future()

        def work() -> None:
            self._first()
            try:
                future.set_result(fn(*args, **kwargs))
            except BaseException as error:
                future.set_exception(error)

        threading.Thread(target=work, name=self._name, daemon=True).start()
        return future


def diagnosing() -> Beside:
    """Where a session diagnoses: beside it, and with what polling leaves of the processor."""
    return Beside("diagnosis", _step_back)


def _step_back() -> None:
    """Let the session go first; threads that this one starts inherit it."""
    if sys.platform == "linux":  # where a thread has a priority of its own
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _PATIENT)
