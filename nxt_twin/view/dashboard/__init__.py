"""The live dashboard: a sink that draws a session in rerun's viewer, in the browser, or into a file.

The viewer and the file each live in a process of their own behind a bounded queue. A viewer that is dead, slow or
missing delays neither the loop nor the file.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Final, Literal, final

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.columns import Port
from nxt_twin.twin.records import Event, Tick
from nxt_twin.view.dashboard.feeder import Feeder
from nxt_twin.view.dashboard.job import DashboardJob
from nxt_twin.view.dashboard.page import page_url
from nxt_twin.view.dashboard.scene import WorldMessage
from nxt_twin.view.dashboard.viewer import find_viewer, free_port, require_display

_VIEWER: Final = "viewer"
_VIEWER_PATIENCE_S: Final = 2.0
_FILE_PATIENCE_S: Final = 60.0
"""A busy machine takes 10 s to begin a file, and a file that is given up loses the session's end."""

_LONGEST_TROUBLE: Final = 300
_STYLED: Final = re.compile(r"\x1b\[[0-9;]*m")


@final
class Dashboard:
    """A session's sink; `tick` and `event` neither block nor raise.

    Args:
        viewer: what the viewer's process is to do; None for no viewer.
        file: what the file's process is to do; None for no file.
        lossless: whether to wait for slow processes instead of dropping what is oldest.
    """

    def __init__(
        self, viewer: DashboardJob | None, file: DashboardJob | None, *, lossless: bool = False
    ) -> None:
        self._url = (
            "" if viewer is None or viewer.kind != "web" else page_url(viewer.page_port, viewer.data_port)
        )
        self._troubles: list[str] = []
        self._parts: list[tuple[str, Feeder, IO[bytes]]] = []
        for name, job, patience_s in (
            (_VIEWER, viewer, _VIEWER_PATIENCE_S),
            ("file", file, _FILE_PATIENCE_S),
        ):
            if job is not None:
                log = tempfile.TemporaryFile()  # noqa: SIM115 - closed in close()
                self._parts.append(
                    (name, Feeder(job.command(), patience_s=patience_s, log=log, lossless=lossless), log)
                )
        self._feeders = tuple(feeder for _, feeder, _ in self._parts)

    @property
    def url(self) -> str:
        """What to open in a browser; empty where nothing is served."""
        return self._url

    @property
    def waiting(self) -> int:
        """Polls and events that are still on their way to a viewer or file."""
        return sum(feeder.waiting for feeder in self._feeders)

    @property
    def processes(self) -> tuple[int, ...]:
        """The dashboard's processes, by their ids."""
        return tuple(feeder.pid for feeder in self._feeders)

    @property
    def dropped(self) -> int:
        """Polls and events that were not shown because a viewer did not keep up."""
        return sum(feeder.dropped for feeder in self._feeders)

    @property
    def troubles(self) -> tuple[str, ...]:
        """After `close`: a line for each part that did not end well."""
        return tuple(self._troubles)

    def tick(self, tick: Tick) -> None:
        """Take one poll."""
        for feeder in self._feeders:
            feeder.put(tick)

    def event(self, event: Event) -> None:
        """Take one event."""
        for feeder in self._feeders:
            feeder.put(event)

    def show(self, message: WorldMessage) -> None:
        """Take something of a robot's world; it neither blocks nor raises."""
        for feeder in self._feeders:
            feeder.put(message)

    @property
    def serving(self) -> bool:
        """Whether browsers are served."""
        return bool(self._url) and any(name == _VIEWER and feeder.alive for name, feeder, _ in self._parts)

    def rest(self) -> None:
        """The session is over: nothing more comes, and what is served to browsers goes on being served."""
        for name, feeder, _ in self._parts:
            if not (self._url and name == _VIEWER):
                feeder.finish()

    def close(self) -> None:
        """End the processes; a viewer that hangs is given up, a native window stays open."""
        for feeder in self._feeders:
            feeder.finish()
        for name, feeder, log in self._parts:
            if log.closed:
                continue
            status = feeder.close()
            if status != 0:
                log.seek(0)
                words = _STYLED.sub("", log.read().decode(errors="replace")).strip().splitlines()
                said = f": {words[-1][:_LONGEST_TROUBLE]}" if words else ""
                ended = (
                    "did not finish in time and was ended" if status < 0 else f"ended with status {status}"
                )
                self._troubles.append(f"the dashboard's {name} {ended}{said}")
            log.close()


def open_dashboard(
    *,
    view: Literal["spawn", "web", "none"],
    save: Path | None,
    ports: Sequence[Port],
    channels: Sequence[str],
    title: str,
    web_port: int = 0,
    tab: int = 0,
    lossless: bool = False,
    world: bool = False,
) -> Dashboard:
    """Start the dashboard; returns at once, while the viewer is still starting.

    Args:
        view: a native window, served to browsers on this machine, or nothing to look at.
        save: a `.rrd` file to write beside it.
        ports: of the motors to show.
        channels: the sensors' columns to show.
        title: of the session.
        web_port: where browsers come to; 0 for any free port.
        tab: which tab is in front: the motors in order, then the sensors; -1 shows the first motor's story alone.
        lossless: for replays only: wait for a slow viewer or disk instead of dropping polls.
        world: whether a robot's world is shown, of which `Dashboard.show` then tells.

    Raises:
        NxtTwinError: rerun is not installed, there is no display, the port is taken, or the file cannot be written.
    """
    if view == "none" and save is None:
        return Dashboard(None, None)
    find_viewer()
    viewer = file = None
    if view == "spawn":
        require_display()
        viewer = DashboardJob(
            "spawn", title, tuple(ports), tuple(channels), data_port=free_port(), tab=tab, world=world
        )
    elif view == "web":
        page_port, data_port, parts_port = _three_ports(web_port)
        viewer = DashboardJob(
            "web", title, tuple(ports), tuple(channels),
            data_port=data_port, page_port=page_port, parts_port=parts_port, tab=tab, world=world,
        )  # fmt: skip
    if save is not None:
        _check_writable(save)
        file = DashboardJob(
            "file", title, tuple(ports), tuple(channels), file=str(save.absolute()), tab=tab, world=world
        )
    return Dashboard(viewer, file, lossless=lossless)


def _three_ports(web_port: int) -> tuple[int, int, int]:
    page_port = free_port(web_port)
    data_port = parts_port = page_port
    while data_port == page_port:
        data_port = free_port()
    while parts_port in (page_port, data_port):
        parts_port = free_port()
    return page_port, data_port, parts_port


def _check_writable(save: Path) -> None:
    try:
        save.parent.mkdir(parents=True, exist_ok=True)
        save.touch()
    except OSError as error:
        raise NxtTwinError(
            "cannot be written", where=str(save), mend="choose another file for the dashboard"
        ) from error
