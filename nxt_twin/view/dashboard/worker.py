"""The dashboard's own process: takes lines from its standard input until that ends, and draws them in batches."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path
from queue import Queue
from typing import Any, Final, Literal

from nxt_twin.twin.records import Event, Tick
from nxt_twin.view.dashboard.job import DashboardJob, job_of
from nxt_twin.view.dashboard.page import Page
from nxt_twin.view.dashboard.scene import Scenery, WorldMessage, WorldMoment
from nxt_twin.view.dashboard.viewer import LOOPBACK, find_viewer, listens, start_viewer
from nxt_twin.view.dashboard.wire import read

_SHOWN_EVERY_S: Final = 0.25
_WRITTEN_EVERY_S: Final = 2.0

_MOST_GATHERED: Final = 500
_START_S: Final = 20.0
_START_STEP_S: Final = 0.05
_LAST_LOOK_S: Final = 0.3


def main() -> int:
    """Do the job named by the one argument."""
    job = job_of(sys.argv[1])
    viewer, page = _open_viewer(job)
    try:
        # rerun is imported here, after the viewer has begun to start.
        from nxt_twin.view.dashboard.drawing.painter import Painter

        sink = Path(job.file) if job.kind == "file" else f"rerun+http://{LOOPBACK}:{job.data_port}/proxy"
        if viewer is not None and not _await(viewer, job.data_port):
            sys.stderr.write("the viewer did not start\n")
            return 1
        painter = Painter(job.title, job.ports, job.channels, sink, job.tab, world=job.world)
        draw(sys.stdin.buffer, painter, _WRITTEN_EVERY_S if job.kind == "file" else _SHOWN_EVERY_S)
        painter.close()
        if viewer is not None and page is not None:
            _linger(viewer)
    finally:
        if page is not None:
            page.close()
        if viewer is not None and job.kind == "web":
            viewer.kill()
    return 0


def draw(lines: Iterable[bytes], painter: Any, batch_s: float) -> None:  # noqa: ANN401 - imported late
    """Let a `Painter` paint lines in batches of `batch_s` of the session's own time.

    Events are not kept waiting, and lines that have queued up meanwhile are painted at one go.
    """
    ticks: list[Tick] = []
    events: list[Event] = []
    notes: list[tuple[float, str]] = []
    world: list[WorldMessage] = []
    now_s = 0.0
    for gathered in _gathered(lines):
        for message in map(read, gathered):
            if isinstance(message, Tick):
                ticks.append(message)
                now_s = message.received_s
            elif isinstance(message, Event):
                events.append(message)
            elif isinstance(message, Scenery | WorldMoment):
                world.append(message)
            else:
                notes.append((now_s, f"dashboard: {message} polls were dropped, the viewer did not keep up"))
        if events or (ticks and now_s - ticks[0].received_s >= batch_s):
            painter.paint(ticks, events, notes, world)
            ticks, events, notes, world = [], [], [], []
    if ticks or events or notes or world:
        painter.paint(ticks, events, notes, world)


def _gathered(lines: Iterable[bytes]) -> Iterator[list[bytes]]:
    """The lines, as many at a time as have arrived."""
    arrived: Queue[bytes | None] = Queue(_MOST_GATHERED)

    def fetch() -> None:
        for line in lines:
            arrived.put(line)
        arrived.put(None)

    threading.Thread(target=fetch, name="dashboard reader", daemon=True).start()
    while (line := arrived.get()) is not None:
        some = [line]
        while not arrived.empty() and len(some) < _MOST_GATHERED:
            following = arrived.get()
            if following is None:
                yield some
                return
            some.append(following)
        yield some


def _open_viewer(job: DashboardJob) -> tuple[subprocess.Popen[bytes] | None, Page | None]:
    if job.kind not in ("spawn", "web"):
        return None, None
    kind: Literal["spawn", "web"] = "web" if job.kind == "web" else "spawn"
    viewer = start_viewer(find_viewer(), kind, port=job.data_port, page_port=job.parts_port)
    page = Page(job.page_port, job.parts_port, job.data_port) if kind == "web" else None
    return viewer, page


def _await(viewer: subprocess.Popen[bytes], port: int) -> bool:
    """Wait until the viewer listens; connecting earlier would stall the stream."""
    pause = threading.Event()
    for _ in range(int(_START_S / _START_STEP_S)):
        if listens(port):
            return True
        if viewer.poll() is not None:
            return False
        pause.wait(_START_STEP_S)
    return False


def _linger(viewer: subprocess.Popen[bytes]) -> None:
    """Leave browsers a moment to fetch the last batch."""
    try:
        viewer.wait(_LAST_LOOK_S)
    except subprocess.TimeoutExpired:
        return


if __name__ == "__main__":
    sys.exit(main())
