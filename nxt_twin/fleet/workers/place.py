"""Where tasks are done."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final


@final
@dataclass(frozen=True)
class Here:
    """In this process, one after another."""


@final
@dataclass(frozen=True)
class Processes:
    """In `count` processes of this machine; one that is killed is replaced, and its task is done again."""

    count: int


@final
@dataclass(frozen=True)
class Cluster:
    """On the workers of the Dask scheduler at `address`, such as `tcp://127.0.0.1:8786`."""

    address: str


Place = Here | Processes | Cluster
HERE: Final[Place] = Here()


def place_of(jobs: int, cluster: str | None) -> Place:
    """The place that a command's options name: the cluster where there is one, else a number of processes."""
    if cluster is not None:
        return Cluster(cluster)
    return Here() if jobs == 1 else Processes(jobs)
