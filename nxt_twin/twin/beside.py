"""Work beside a session that the session's end does not wait for."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, TypeVar, final

T = TypeVar("T")


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
