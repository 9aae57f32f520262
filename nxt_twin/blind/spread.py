"""Spread cases over processes or a cluster, and tell how each ended."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Protocol, final

from nxt_twin.fleet.workers.each import each
from nxt_twin.fleet.workers.place import Place

NameAndFailure = tuple[str, str]
"""A case's name, and why it failed: empty where it did not."""


class CaseWork(Protocol):
    """A function of a module that does something with a case; its first argument names the case."""

    def __call__(self, *task: Any) -> NameAndFailure:  # noqa: ANN401 - each has tasks of its own
        """Do it, and say how it ended."""
        ...


@final
@dataclass(frozen=True)
class CaseTask:
    """What `work` is to be called with, under the case's name."""

    name: str
    work: CaseWork
    arguments: tuple[Any, ...]


def spread(tasks: Iterable[CaseTask], place: Place) -> Iterator[NameAndFailure]:
    """Do each task, and yield its outcome as it ends; one that raises, or kills its workers, fails alone.

    Raises:
        FleetError: the place is a cluster that cannot be reached.
    """
    with closing(each(_done, tasks, place)) as outcomes:  # type: ignore[type-var]
        for outcome in outcomes:
            name = outcome.task.name
            yield outcome.result or (
                name,
                f"{name}: {outcome.failure.text if outcome.failure else 'no answer'}",
            )


def _done(task: CaseTask) -> NameAndFailure:
    return task.work(*task.arguments)
