"""Tasks on a Dask cluster. Dask gives a task to another worker when one dies."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import islice
from typing import Any, Final

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.workers.outcome import CaseOutcome, Failure, ResultT, TaskT, died, raised
from nxt_twin.threads import one_of_many

_CONNECT_S: Final = 10.0
_WAITING_EACH: Final = 2
"""Tasks that are sent ahead for each thread of the cluster, so that none waits for the next."""
_ALONE: Final = threading.Lock()
_SETTINGS: Final = {"distributed.admin.large-graph-warning-threshold": "1GB"}


def on_cluster(
    work: Callable[[TaskT], ResultT], tasks: Iterable[TaskT], address: str
) -> Iterator[CaseOutcome[TaskT, ResultT]]:
    """Yield the outcome of `work(task)` for each task, in the order in which they end.

    Raises:
        FleetError: Dask is not installed, nothing answers at `address`, or no worker has joined the cluster.
    """
    with _client(address) as client:
        from distributed import as_completed

        if not client.nthreads():
            mend = f"start some: dask worker {address} --nthreads 1"
            raise FleetError("has no workers", where=f"cluster {address}", mend=mend)
        waiting = iter(tasks)
        running: dict[str, TaskT] = {}
        ended = as_completed()  # type: ignore[no-untyped-call]

        def fill() -> None:
            room = _WAITING_EACH * max(sum(client.nthreads().values()), 1) - len(running)
            for task in islice(waiting, max(room, 0)):
                future = client.submit(_alone, work, task, pure=False)
                running[future.key] = task
                ended.add(future)  # type: ignore[no-untyped-call]

        fill()
        for future in ended:
            task = running.pop(future.key)
            error = future.exception()
            yield CaseOutcome(task, None if error else future.result(), _failure(error) if error else None)
            future.release()
            fill()


@contextmanager
def _client(address: str) -> Iterator[Any]:
    try:
        import dask
        from distributed import Client
    except ImportError:
        mend = "pip install 'nxt-twin[fleet]'"
        raise FleetError("a cluster needs Dask, which is not installed", mend=mend) from None
    logging.getLogger("distributed").setLevel(logging.ERROR)
    with dask.config.set(_SETTINGS):
        try:
            client = Client(address, timeout=_CONNECT_S)  # type: ignore[no-untyped-call]
        except (OSError, ValueError, TimeoutError) as error:
            mend = "start one: dask scheduler, then dask worker ADDRESS --nthreads 1"
            raise FleetError(
                f"no Dask scheduler answers: {error}", where=f"cluster {address}", mend=mend
            ) from None
        with client:
            yield client


def _alone(work: Callable[[TaskT], ResultT], task: TaskT) -> ResultT:
    """Do a task on a worker, one at a time in each process: a compiled kernel has one workspace."""
    with _ALONE, one_of_many():
        return work(task)


def _failure(error: Exception) -> Failure:
    from distributed import KilledWorker

    return died() if isinstance(error, KilledWorker) else raised(error)
