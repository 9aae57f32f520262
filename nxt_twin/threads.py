"""How many threads work: one for linear algebra, and one for simulations wherever the processes share the cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Final, ParamSpec, TypeVar, final

Arguments = ParamSpec("Arguments")
ResultT = TypeVar("ResultT")

_VARIABLES: Final = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
_ALONE: Final[ContextVar[bool]] = ContextVar("alone", default=False)


def ask_for_one_thread() -> None:
    """Let this program, and those that it starts, do linear algebra in one thread, unless the user says otherwise.

    Our matrices have some ten rows, and a library's further threads only wait, busily. The libraries read their number
    of threads when numpy is imported: call it before. It changes the environment of the whole process, so that only
    the command line and whatever starts workers call it. `import nxt_twin` leaves the choice to who imports.
    """
    if not any(name in os.environ for name in _VARIABLES):
        os.environ.update(dict.fromkeys(_VARIABLES, "1"))


@contextmanager
def one_of_many() -> Iterator[None]:
    """Simulate in the calling thread alone: this process is one of many that share the cores.

    Threads of each would outnumber the cores, and every hand-over between them would wait for a core.
    """
    token = _ALONE.set(True)
    try:
        yield
    finally:
        _ALONE.reset(token)


def threads_for(count: int | None) -> tuple[Executor, int]:
    """Who does simulations, and how many at once: `count` or all cores; the caller itself in `one_of_many`."""
    if _ALONE.get():
        return InPlace(), 1
    count = count or os.cpu_count() or 1
    return ThreadPoolExecutor(count), count


@final
class InPlace(Executor):
    """Does each task at once, in the thread that submits it; what a task raises, `submit` raises."""

    def submit(
        self, fn: Callable[Arguments, ResultT], /, *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[ResultT]:
        """The result of `fn`, which has ended."""
        done: Future[ResultT] = Future()
        done.set_result(fn(*args, **kwargs))
        return done
