"""A mock brick served in a thread of this process, for as long as a `with` block lasts."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from typing import Final, Protocol

from nxt_twin.mock.errors import ServeError
from nxt_twin.mock.run import Served

_STARTED_WITHIN_S: Final = 60.0
_ENDED_WITHIN_S: Final = 5.0


class Serving(Protocol):
    """`nxt_twin.mock.run.serve` with all said but these two."""

    def __call__(self, *, announce: Callable[[Served], None], stop: Callable[[], bool]) -> None:
        """Serve until `stop` says so."""
        ...


@contextmanager
def served_in_thread(serve: Serving) -> Iterator[Served]:
    """Serve while the block lasts; gives where.

    Raises:
        NxtTwinError: what `serve` raises before it has announced anything.
        ServeError: nothing was announced in time.
    """
    said: SimpleQueue[Served | BaseException] = SimpleQueue()
    over = threading.Event()

    def run() -> None:
        try:
            serve(announce=said.put, stop=over.is_set)
        except Exception as error:  # raised below, where the user called
            said.put(error)

    thread = threading.Thread(target=run, name="mock brick", daemon=True)
    thread.start()
    try:
        yield _announced(said)
    finally:
        over.set()
        thread.join(_ENDED_WITHIN_S)


def _announced(said: SimpleQueue[Served | BaseException]) -> Served:
    try:
        first = said.get(timeout=_STARTED_WITHIN_S)
    except Empty:
        raise ServeError("did not start in time", where="mock brick", mend="try again") from None
    if isinstance(first, BaseException):
        raise first
    return first
