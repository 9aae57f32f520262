"""A disk that is full after every byte of a recording: the rows before are there, and the failure is one line."""

from __future__ import annotations

import resource
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import numpy as np

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.lags import RowLags
from nxt_twin.recording.stream import RecordingWriter, recover, stream_path

_ROWS: Final = 30
_COLUMNS: Final = ("time_s", "a_power_pct", "a_tacho_deg")


def report() -> Iterator[str]:
    """What came of it while rows came in, and while the recording was finished."""
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole.parquet"
        with RecordingWriter(whole, _COLUMNS) as writer:
            _fill(writer)
            stream_size = stream_path(whole).stat().st_size
        rows = Counter(_full_while_rows_come(Path(folder) / "r.csv", size) for size in range(stream_size + 1))
        ends = Counter(
            _full_at_the_end(Path(folder) / "e.parquet", size) for size in range(whole.stat().st_size + 1)
        )
    for when, seen in (("while rows come", rows), ("at the end", ends)):
        told = ", ".join(f"{number} {what}" for what, number in seen.most_common())
        yield f"disk full after each of {sum(seen.values())} bytes {when}: {told}"


def _full_while_rows_come(path: Path, size: int) -> str:
    sure = 0
    try:
        with _disk_of(size), RecordingWriter(path, _COLUMNS) as writer:
            writer.keep_lags(RowLags())
            for number in range(_ROWS):
                writer.row(_row(number))
                sure += 1
        what = "no failure"
    except (NxtTwinError, OSError) as failure:
        what = "told" if "\n" not in str(failure) else "LINES"
    return _all_there(path, sure, what)


def _full_at_the_end(path: Path, size: int) -> str:
    writer = RecordingWriter(path, _COLUMNS)
    _fill(writer)
    try:
        with _disk_of(size):
            writer.finish()
        what = "no failure"
    except (NxtTwinError, OSError) as failure:
        what = "told" if "\n" not in str(failure) else "LINES"
    return _all_there(path, _ROWS, what)


def _all_there(path: Path, sure: int, what: str) -> str:
    """Whether all rows that were taken are in the recording or in the stream; all is then cleared away."""
    try:
        if path.exists():
            counts = read_recording(path).columns["a_tacho_deg"] if sure > 1 else np.arange(float(sure))
        else:
            counts = recover(path).recording.columns["a_tacho_deg"] if sure else np.zeros(0)
        right = counts.size >= sure and np.array_equal(counts, np.arange(float(counts.size)))
    except NxtTwinError:
        right = not sure
    for left in path.parent.glob(f"*{path.stem}.*"):
        left.unlink()
    return f"{what}, {'nothing lost' if right else 'LOST'}"


@contextmanager
def _disk_of(size: int) -> Iterator[None]:
    """No file may grow beyond so many bytes: the system answers as it does on a full disk, with part of a write."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def _fill(writer: RecordingWriter) -> None:
    for number in range(_ROWS):
        writer.row(_row(number))


def _row(number: int) -> dict[str, float]:
    return {"time_s": number / 100, "a_power_pct": 40.0, "a_tacho_deg": float(number)}
