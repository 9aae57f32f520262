"""What became of a task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Generic, Literal, TypeVar, final

TaskT = TypeVar("TaskT")
ResultT = TypeVar("ResultT")

MOST_DEATHS: Final = 3
"""Workers that may die over one task: then it is the task that kills them."""


@final
@dataclass(frozen=True)
class Failure:
    """Why a task has no result.

    Attributes:
        kind: `raised` where the function raised, `died` where each worker that was given the task died.
        text: one line.
    """

    kind: Literal["raised", "died"]
    text: str


@final
@dataclass(frozen=True)
class CaseOutcome(Generic[TaskT, ResultT]):
    """A task with its result, or with why there is none.

    Attributes:
        task: as it was given.
        result: what the function returned; None where it failed.
        failure: None where it did not.
    """

    task: TaskT
    result: ResultT | None
    failure: Failure | None = None


def raised(error: Exception) -> Failure:
    """The failure of a function that raised `error`."""
    return Failure("raised", f"{type(error).__name__}: {' '.join(str(error).split())}")


def died() -> Failure:
    """The failure of a task that killed its workers, or that they were killed over."""
    return Failure("died", "each worker that took it died, killed or out of memory")
