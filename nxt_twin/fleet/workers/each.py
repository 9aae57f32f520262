"""Apply one function to each of many tasks, wherever that is to happen."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from nxt_twin.fleet.workers.outcome import CaseOutcome, ResultT, TaskT, raised
from nxt_twin.fleet.workers.place import Cluster, Place, Processes
from nxt_twin.fleet.workers.processes import in_processes


def each(
    work: Callable[[TaskT], ResultT], tasks: Iterable[TaskT], place: Place
) -> Iterator[CaseOutcome[TaskT, ResultT]]:
    """Yield the outcome of `work(task)` for each task, as they come.

    Tasks are taken only as workers become free, so that many of them cost no memory. Close the iterator to stop
    the workers early.

    Args:
        work: a function of a module, so that other processes find it by its name.
        tasks: values that can be sent to another process.
        place: where to work.

    Raises:
        FleetError: the cluster cannot be reached, or Dask is not installed.
    """
    if isinstance(place, Cluster):
        # Dask is an extra and takes half a second to import.
        from nxt_twin.fleet.workers.cluster import on_cluster

        return on_cluster(work, tasks, place.address)
    if isinstance(place, Processes):
        return in_processes(work, tasks, place.count)
    return (_done(work, task) for task in tasks)


def _done(work: Callable[[TaskT], ResultT], task: TaskT) -> CaseOutcome[TaskT, ResultT]:
    try:
        return CaseOutcome(task, work(task))
    except Exception as error:
        return CaseOutcome(task, None, raised(error))
