"""The task of a process of the dashboard, as its one argument."""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass
from json import dumps, loads
from typing import Final, Literal, final

from nxt_twin.recording.columns import Port

_WORKER: Final = "nxt_twin.view.dashboard.worker"


@final
@dataclass(frozen=True)
class DashboardJob:
    """The task of the process; travels as its one argument.

    Attributes:
        kind: a file, a native viewer, or the web.
        title: the recording's name.
        ports: of the motors shown.
        channels: the sensors' columns shown.
        file: to write.
        data_port: where the viewer takes data.
        page_port: where browsers come to.
        parts_port: where rerun serves the page's parts.
        tab: which tab is in front.
        world: whether a robot's world is shown, in a tab before the motors'.
    """

    kind: Literal["file", "spawn", "web"]
    title: str
    ports: tuple[Port, ...]
    channels: tuple[str, ...]
    file: str = ""
    data_port: int = 0
    page_port: int = 0
    parts_port: int = 0
    tab: int = 0
    world: bool = False

    def command(self) -> list[str]:
        """What starts the process."""
        return [sys.executable, "-m", _WORKER, dumps(asdict(self))]


def job_of(argument: str) -> DashboardJob:
    """The job that `DashboardJob.command` wrote down."""
    known = loads(argument)
    return DashboardJob(**{**known, "ports": tuple(known["ports"]), "channels": tuple(known["channels"])})
