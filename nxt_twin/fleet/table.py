"""The fleet's table on disk: Parquet, and a journal beside it that takes each row at once."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import IO, Any, Final, final

import pyarrow as pa
import pyarrow.parquet

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.finding.labels import Labels
from nxt_twin.fleet.finding.sessions import identity
from nxt_twin.fleet.row import SCHEMA, TRANSIENT, Row

_ROWS_AT_ONCE: Final = 1000


@final
class FleetTable:
    """Rows by unit and session. A row that was added stays, whatever ends the program; use it in a `with` block.

    Args:
        path: of the Parquet file; the journal is `PATH.journal` until the block ends.

    Raises:
        FleetError: the file is no fleet's table, or another program is adding to it.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._journal = path.with_name(f"{path.name}.journal")
        if path.exists():
            _check(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = self._journal.open("a+b")
        _lock(self._file, self._journal)
        self._cut_torn_end()

    def __enter__(self) -> FleetTable:
        return self

    def __exit__(self, *_: object) -> None:
        self.fold()
        self._file.close()

    def done(self) -> set[str]:
        """The keys of all rows that need not be made again."""
        keys = {row["key"] for row in self._added() if row["failure"] not in TRANSIENT}
        for batch in _batches(self._path, ["key", "failure"]):
            keys |= {row["key"] for row in batch.to_pylist() if row["failure"] not in TRANSIENT}
        return keys

    def add(self, row: Row) -> None:
        """Add a row; it is on the disk when this comes back."""
        self._file.write(json.dumps(row).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def fold(self) -> None:
        """Move the journal's rows into the table, in the places of older rows of their sessions."""
        last = {_identity(row): number for number, row in enumerate(self._added())}
        if last:
            partial = self._path.with_name(f".{self._path.name}.partial")
            with pa.parquet.ParquetWriter(partial, SCHEMA) as writer:
                for batch in _batches(self._path):
                    kept = [row for row in batch.to_pylist() if _identity(row) not in last]
                    _write(writer, kept)
                fresh = (row for n, row in enumerate(self._added()) if last[_identity(row)] == n)
                while rows := list(islice(fresh, _ROWS_AT_ONCE)):
                    _write(writer, rows)
            partial.replace(self._path)
        self._file.truncate(0)
        self._journal.unlink()

    def _added(self) -> Iterator[Row]:
        """The journal's rows."""
        with self._journal.open("rb") as file:
            for line in file:
                yield json.loads(line)

    def _cut_torn_end(self) -> None:
        """Leave out what a killed program wrote of its last line."""
        size = self._journal.stat().st_size
        with self._journal.open("rb") as file:
            whole = sum(len(line) for line in file if line.endswith(b"\n"))
        if whole < size:
            self._file.truncate(whole)


def read_columns(path: Path, columns: list[str]) -> pa.Table:
    """Columns of a table.

    Raises:
        FleetError: there is no table, or it is no fleet's.
    """
    if not path.exists():
        raise FleetError(
            "there is no such table", where=str(path), mend="nxt-twin fleet diagnose FOLDER --out it"
        )
    _check(path)
    return pa.parquet.read_table(path, columns=columns)


def _check(path: Path) -> None:
    mend = "name another file by --out"
    try:
        schema = pa.parquet.read_schema(path)
    except (pa.ArrowException, OSError):
        raise FleetError("is no readable Parquet file", where=str(path), mend=mend) from None
    if not schema.equals(SCHEMA):
        raise FleetError("is no table of this program's fleets", where=str(path), mend=mend)


def _batches(path: Path, columns: list[str] | None = None) -> Iterator[pa.RecordBatch]:
    if path.exists():
        with pa.parquet.ParquetFile(path) as file:
            yield from file.iter_batches(_ROWS_AT_ONCE, columns=columns)


def _write(writer: pa.parquet.ParquetWriter, rows: list[Row]) -> None:
    if rows:
        writer.write_batch(pa.RecordBatch.from_pylist(rows, schema=SCHEMA))


def _identity(row: Row) -> bytes:
    return identity(Labels(row["unit"], row["session"]))


def _lock(file: IO[Any], path: Path) -> None:
    """Keep others from adding; where the system cannot, nothing does."""
    try:
        import fcntl
    except ImportError:
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        mend = "wait for it, or name another table by --out"
        raise FleetError("another program adds to this table", where=str(path), mend=mend) from None
