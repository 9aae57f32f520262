"""A recording that grows while the brick is polled, and that a crash cannot take away.

Beside the recording NAME there is NAME.stream: an Arrow stream whose small batches are handed to the system whenever
half a second of rows has come together. So a program that is killed loses at most that; a power cut may lose what the
system has not put on the disk yet, some seconds more. Waiting for the disk after each batch would hold the polls up, so
that is done once, at the end, when all becomes the recording itself, whole or not at all.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final, final

import numpy as np
import pyarrow as pa
import pyarrow.ipc

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.columns import CATALOGUE, TIME, check_names
from nxt_twin.recording.files import write_recording
from nxt_twin.recording.recording import Recording

STREAM_SUFFIX: Final = ".stream"
BATCH_S: Final = 0.5
_ROWS_MOST: Final = 4096
_SUFFIXES: Final = (".csv", ".parquet")


def stream_path(path: Path) -> Path:
    """Where the rows of a recording are kept until it is finished."""
    return path.with_name(path.name + STREAM_SUFFIX)


@final
class RecordingWriter:
    """Writes a recording row by row; a context manager that finishes it, whatever happened.

    Args:
        path: the recording, `.parquet` or `.csv`; it is there when the writer has finished.
        columns: contract 1's columns that rows may fill, `time_s` among them.

    Raises:
        RecordingError: the path is taken, of another suffix, or cannot be written; or a column is none.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        check_names(columns, path)
        check_free(path)
        self.path = path
        self.rows = 0
        self._columns = tuple(columns)
        self._pending: list[Mapping[str, float]] = []
        self._stream = stream_path(path)
        self._schema = pa.schema([(name, pa.float64()) for name in self._columns])
        try:
            # Unbuffered: what is written is the system's at once.
            self._file = self._stream.open("xb", buffering=0)
        except OSError as failure:
            what = f"cannot be written: {failure.strerror}"
            raise RecordingError(what, where=str(self._stream), mend="check the folder") from None
        self._writer = pa.ipc.new_stream(self._file, self._schema)
        self._open = True

    def __enter__(self) -> RecordingWriter:
        return self

    def __exit__(self, *_: object) -> None:
        self.finish()

    def row(self, values: Mapping[str, float]) -> None:
        """Append one row.

        Args:
            values: contract 1's columns by name, modes as indices into `DRIVE_MODES`; what is left out or NaN was
                not sampled.

        Raises:
            RecordingError: a column that was not announced, or the disk is full.
        """
        unknown = values.keys() - set(self._columns)
        if unknown:
            what = f"no column {', '.join(sorted(unknown))} was announced"
            raise RecordingError(what, where=str(self.path))
        self._pending.append(dict(values))
        self.rows += 1
        span_s = values[TIME] - self._pending[0][TIME]
        if span_s >= BATCH_S or len(self._pending) >= _ROWS_MOST:
            self._flush()

    def finish(self) -> Path | None:
        """Make the recording out of the rows; doing so again does nothing.

        Returns:
            Its path; None where there was no row.

        Raises:
            RecordingError: it cannot be written; the rows are still in the stream.
        """
        if not self._open:
            return self.path if self.rows else None
        self._open = False
        self._flush()
        self._writer.close()
        os.fsync(self._file.fileno())
        self._file.close()
        if self.rows:
            write_recording(_read_stream(self._stream, self.path), self.path)
        self._stream.unlink()
        return self.path if self.rows else None

    def close(self) -> None:
        """Finish."""
        self.finish()

    def _flush(self) -> None:
        if not self._pending:
            return
        arrays = [
            pa.array([row.get(name, np.nan) for row in self._pending], type=pa.float64())
            for name in self._columns
        ]
        try:
            self._writer.write_batch(pa.record_batch(arrays, schema=self._schema))
        except OSError as failure:
            what = f"cannot be written: {failure.strerror or failure}"
            raise RecordingError(what, where=str(self._stream), mend="make room") from None
        self._pending.clear()


def recover(path: Path) -> Recording:
    """Make the recording out of a stream that was cut off, and remove the stream.

    Args:
        path: the recording, or its stream.

    Returns:
        The recording, which is at `path` now.

    Raises:
        RecordingError: there is no stream, nothing in it is whole, or the recording is there already.
    """
    final_path = path.with_name(path.name.removesuffix(STREAM_SUFFIX))
    stream = stream_path(final_path)
    if not stream.is_file():
        what = "there is nothing to recover"
        raise RecordingError(
            what, where=str(final_path), mend=f"a recording that was cut off has a {stream.name}"
        )
    if final_path.suffix.lower() not in _SUFFIXES:
        raise RecordingError("is neither .csv nor .parquet", where=str(final_path), mend="change the suffix")
    if final_path.exists():
        raise RecordingError(
            "is there already", where=str(final_path), mend=f"move it, or delete {stream.name}"
        )
    recording = _read_stream(stream, final_path)
    write_recording(recording, final_path)
    stream.unlink()
    return recording


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


def _read_stream(stream: Path, path: Path) -> Recording:
    batches = list(_whole_batches(stream))
    if not batches:
        what = "nothing in it is whole"
        raise RecordingError(
            what, where=str(stream), mend="it was cut off in its first half second; delete it"
        )
    names = batches[0].schema.names
    check_names(names, stream)
    columns: dict[str, FloatArray] = {
        name: np.concatenate([batch.column(name).to_numpy(zero_copy_only=False) for batch in batches])
        for name in names
    }
    sampled = {
        name: values for name, values in columns.items() if name == TIME or not np.all(np.isnan(values))
    }
    _check_words(sampled, stream)
    return Recording(path.name, sampled)


def _whole_batches(stream: Path) -> Iterator[pa.RecordBatch]:
    """All batches up to where the stream was cut off."""
    with stream.open("rb") as file, suppress(pa.ArrowInvalid, OSError, EOFError):
        reader = pa.ipc.open_stream(file)
        while True:
            try:
                batch = reader.read_next_batch()
            except StopIteration:
                return
            yield batch


def _check_words(columns: Mapping[str, FloatArray], stream: Path) -> None:
    for name, values in columns.items():
        words = CATALOGUE[name].words
        known = np.isnan(values) | np.isin(values, np.arange(len(words)))
        if words and not known.all():
            raise RecordingError("holds what is no known mode", where=f"{stream}, column {name}")
