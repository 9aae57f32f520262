"""Two programs on one brick: the second is told within seconds, and the first notices nothing."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

from nxt_twin.brick.clock import SystemClock
from nxt_twin.mock.run import serve
from nxt_twin.recording.files import read_recording

_PROGRAM = [sys.executable, "-m", "nxt_twin"]


def report() -> Iterator[str]:
    """What both say, one recording and one asking who the brick is."""
    known, over = threading.Event(), threading.Event()
    urls: list[str] = []

    def announce(place: object) -> None:
        urls.extend(place.urls)  # type: ignore[attr-defined]
        known.set()

    options = {"clock": SystemClock(), "announce": announce, "tcp": "127.0.0.1:0", "stop": over.is_set}
    server = threading.Thread(target=serve, kwargs=options)
    server.start()
    known.wait()
    try:
        with tempfile.TemporaryDirectory() as folder:
            yield from _both(urls[0], Path(folder) / "run.csv")
    finally:
        over.set()
        server.join()


def _both(url: str, out: Path) -> Iterator[str]:
    record = [*_PROGRAM, "record", url, "--out", str(out), "--seconds", "15", "--ports", "a"]
    with subprocess.Popen(record, stdout=subprocess.PIPE, text=True) as first:
        while not out.with_name(f"{out.name}.stream").exists() or not _size(out):
            if first.poll() is not None:
                break
            threading.Event().wait(0.1)
        second = subprocess.run([*_PROGRAM, "connect", url], capture_output=True, text=True, check=False)
        said, _ = first.communicate()
    yield f"second of two clients: status {second.returncode}, {second.stderr.strip()}"
    yield f"first: status {first.returncode}, {said.strip().split(':')[0]}; rows on disk {read_recording(out).rows}"


def _size(out: Path) -> bool:
    return out.with_name(f"{out.name}.stream").stat().st_size > 1000
