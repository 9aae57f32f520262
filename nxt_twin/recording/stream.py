"""A recording that grows while the brick is polled, and that a crash cannot take away.

Beside the recording NAME grows NAME.stream, with one frame a row (`frames`). The system gets each frame at once, so a
killed program loses no row. A power cut may lose the last seconds, which the system has not written yet. Waiting for
the disk after each row would delay the polls. So the writer waits once, at the end, when the stream becomes the
recording, whole or not at all. The first frame, written twice, names the columns.
"""

from __future__ import annotations

import json
import math
import os
import struct
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO, Final, final

import numpy as np

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import CATALOGUE, TIME, check_names
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.frames import Damage, Frame, framed, frames
from nxt_twin.recording.lags import RowLags
from nxt_twin.recording.recording import Recording

STREAM_SUFFIX: Final = ".stream"
_SUFFIXES: Final = (".csv", ".parquet")
_FORMAT: Final = "nxt-twin/stream/1"
_TOLD_MOST: Final = 3


def stream_path(path: Path) -> Path:
    """Where the rows of a recording are kept until it is finished."""
    return path.with_name(path.name + STREAM_SUFFIX)


@final
class RecordingWriter:
    """Writes a recording row by row; a context manager that finishes it, whatever happened.

    Args:
        path: the recording, `.parquet` or `.csv`; it is there when the writer has finished.
        columns: those of docs/formats.md#recordings that rows may fill, `time_s` among them.

    Raises:
        RecordingError: the path is taken, of another suffix, or cannot be written; or a column is none.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        check_names(columns, path)
        check_free(path)
        self.path = path
        self.rows = 0
        self._columns = tuple(columns)
        self._known = frozenset(columns)
        self._stream = stream_path(path)
        self._lags: RowLags | None = None
        self._lags_due = 1
        try:
            # Unbuffered: what is written is the system's at once.
            self._file = self._stream.open("xb", buffering=0)
        except OSError as failure:
            what = f"cannot be written: {failure.strerror}"
            raise RecordingError(what, where=str(self._stream), mend="check the folder") from None
        self._open = True
        _claim(self._file)
        try:
            self._write(2 * framed(0, json.dumps({"format": _FORMAT, "columns": self._columns}).encode()))
        except RecordingError:
            self._file.close()
            self._stream.unlink()  # there is nothing in it
            raise

    def __enter__(self) -> RecordingWriter:
        return self

    def __exit__(self, *_: object) -> None:
        self.finish()

    def keep_lags(self, row_lags: RowLags) -> None:
        """Keep them in the sidecar from now on, renewed each time that twice as many rows are there.

        Raises:
            OSError: the sidecar cannot be written.
        """
        self._lags = row_lags
        row_lags.write_beside(self.path)

    def row(self, values: Mapping[str, float]) -> None:
        """Append one row; it is the system's when this comes back.

        Args:
            values: by column name, modes as indices into `DRIVE_MODES`; what is left out or NaN was
                not sampled.

        Raises:
            RecordingError: a column that was not announced, or the disk is full.
        """
        if unknown := values.keys() - self._known:
            what = f"no column {', '.join(sorted(unknown))} was announced"
            raise RecordingError(what, where=str(self.path))
        cells = struct.pack(
            f"<{len(self._columns)}d", *(values.get(each, math.nan) for each in self._columns)
        )
        self._write(framed(self.rows + 1, cells))
        self.rows += 1
        if self._lags is not None and self.rows >= self._lags_due:
            self._lags_due = 2 * self.rows
            with suppress(OSError):  # the rows matter more, and say themselves when the disk is full
                self._lags.write_beside(self.path)

    def finish(self) -> Path | None:
        """Make the recording out of the rows; doing so again does nothing.

        Returns:
            Its path; None where there was no row.

        Raises:
            RecordingError: it cannot be written, or the stream is damaged; the rows are still in the stream.
            OSError: the sidecar cannot be written; the recording is.
        """
        if not self._open:
            return self.path if self.rows else None
        self._open = False
        with self._file as file:
            with suppress(OSError):  # what cannot be synced cannot be read back either, which is told then
                os.fsync(file.fileno())
            if self.rows:
                _check_whole(_saved(self._stream, self.path), self._stream)
            self._stream.unlink()
        if self._lags is not None:
            (self._lags.write_beside if self.rows else self._lags.remove_beside)(self.path)
        return self.path if self.rows else None

    def close(self) -> None:
        """Finish."""
        self.finish()

    def _write(self, data: bytes) -> None:
        try:
            written = self._file.write(data)
            reason = "" if written == len(data) else "no space left on the device"
        except OSError as failure:
            reason = failure.strerror or str(failure)
        if reason:
            mend = f"make room, then nxt-twin recover {self.path}"
            raise RecordingError(f"cannot be written: {reason}", where=str(self._stream), mend=mend)


@final
@dataclass(frozen=True)
class Recovered:
    """A recording restored from its stream.

    Attributes:
        recording: of all whole rows.
        damages: what could not be read, place and rows in words; then the stream is still there.
    """

    recording: Recording
    damages: tuple[str, ...]


def recover(path: Path) -> Recovered:
    """Make the recording out of a stream that was cut off, and remove the stream if all of it was read.

    Args:
        path: the recording, or its stream.

    Returns:
        The recording, which is at `path` now, and what is damaged.

    Raises:
        RecordingError: there is no stream, somebody writes it, nothing in it is whole, or the recording is there
            already.
    """
    if not path.name:
        raise RecordingError("is no file name", where=str(path), mend="name the recording that was cut off")
    final_path = path.with_name(path.name.removesuffix(STREAM_SUFFIX))
    stream = stream_path(final_path)
    if not stream.is_file():
        what = "there is nothing to recover"
        raise RecordingError(
            what, where=str(final_path), mend=f"a recording that was cut off has a {stream.name}"
        )
    if final_path.suffix.lower() not in _SUFFIXES:
        raise RecordingError("is neither .csv nor .parquet", where=str(final_path), mend="change the suffix")
    with stream.open("rb") as file:
        if not _claim(file):
            raise RecordingError("is being written", where=str(stream), mend="wait for who writes it")
        recovered = _saved(stream, final_path)
        if not recovered.damages:
            stream.unlink()
    return recovered


def check_free(path: Path) -> None:
    """Refuse a place where no recording can begin.

    Raises:
        RecordingError: it is taken, or of another suffix than `.csv` and `.parquet`.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise RecordingError("is neither .csv nor .parquet", where=str(path), mend="change the suffix")
    if path.exists():
        raise RecordingError("is there already", where=str(path), mend="choose another name")
    if stream_path(path).exists():
        mend = f"get it back with nxt-twin recover {path}, or wait for who writes it"
        raise RecordingError("was cut off, or is being written", where=str(path), mend=mend)


def _claim(file: BinaryIO) -> bool:
    """Whether nobody else has claimed the stream, until the file is closed; where there are no locks, always."""
    if sys.platform == "win32":
        return True
    import fcntl

    try:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True


def _saved(stream: Path, path: Path) -> Recovered:
    """The stream's rows, written as the recording."""
    recovered = _read_stream(stream, path)
    write_recording(recovered.recording, path, anew=True)
    return recovered


def _check_whole(recovered: Recovered, stream: Path) -> None:
    if recovered.damages:
        raise RecordingError("; ".join(recovered.damages), where=str(stream), mend="all else was recorded")


def _read_stream(stream: Path, path: Path) -> Recovered:
    found = list(frames(stream.read_bytes()))
    names = _names(found, stream)
    size = 8 * len(names)
    rows = [each for each in found if isinstance(each, Frame) and each.number and len(each.payload) == size]
    if not rows:
        raise RecordingError(
            "nothing in it is whole", where=str(stream), mend="it was cut off before its first row; delete it"
        )
    table = np.frombuffer(b"".join(row.payload for row in rows), dtype="<f8").reshape(len(rows), len(names))
    columns: dict[str, FloatArray] = {
        name: table[:, index].astype(np.float64)
        for index, name in enumerate(names)
        if name == TIME or not np.all(np.isnan(table[:, index]))
    }
    _check_words(columns, stream)
    return Recovered(Recording(path.name, columns), _damages(found, rows))


def _names(found: Sequence[Frame | Damage], stream: Path) -> list[str]:
    """The columns, from whichever of the first frames is whole."""
    heads = [each.payload for each in found if isinstance(each, Frame) and each.number == 0]
    try:
        head = json.loads(heads[0])
        names = [str(name) for name in head["columns"]] if head["format"] == _FORMAT else []
    except (IndexError, ValueError, KeyError, TypeError, RecursionError):
        names = []
    if not names:
        what = "its beginning is damaged, or another version wrote it" if found else "nothing in it is whole"
        raise RecordingError(what, where=str(stream), mend="the stream is kept")
    check_names(names, stream)
    return names


def _damages(found: Sequence[Frame | Damage], rows: Sequence[Frame]) -> tuple[str, ...]:
    """The stretches that could not be read and the rows that are missing, in words."""
    stretches = [each for each in found if isinstance(each, Damage)]
    if not stretches:
        return ()
    places = ", ".join(f"byte {each.offset}" for each in stretches[:_TOLD_MOST])
    more = f" and {len(stretches) - _TOLD_MOST} places more" if len(stretches) > _TOLD_MOST else ""
    numbers = [0, *(row.number for row in rows)]
    gaps = [_span(low + 1, high - 1) for low, high in pairwise(numbers) if high > low + 1]
    if isinstance(found[-1], Damage):
        gaps.append(f"all after {numbers[-1]}")
    lost = f"rows lost: {', '.join(gaps[:_TOLD_MOST])}" if gaps else "no row is lost"
    return (f"damaged at {places}{more}", f"{lost}{', …' if len(gaps) > _TOLD_MOST else ''}")


def _span(low: int, high: int) -> str:
    return f"{low}" if low == high else f"{low} to {high}"


def _check_words(columns: Mapping[str, FloatArray], stream: Path) -> None:
    for name, values in columns.items():
        words = CATALOGUE[name].words
        known = np.isnan(values) | np.isin(values, np.arange(len(words)))
        if words and not known.all():
            raise RecordingError("holds what is no known mode", where=f"{stream}, column {name}")
