"""A run's folder: the experiment as it was asked for, its recordings, and what was identified.

The recordings show how far a run has come. A complete one is `recordings/NAME.csv`. One that is under way is
`recordings/NAME.csv.part`, written row by row; a crash may cut its last line off.
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Final, Self, TextIO, final

from nxt_twin.experiment.errors import ExperimentError
from nxt_twin.experiment.plan import Experiment, dump_experiment
from nxt_twin.recording.files import read_recording
from nxt_twin.recording.recording import Recording

EXPERIMENT_FILE: Final = "experiment.yaml"
_PART: Final = ".part"

IndexRow = Mapping[str, float | str | None]


@final
class RunFolder:
    """A folder for one run of one experiment, new or to be gone on with.

    Args:
        path: the folder; made if it is not there.
        experiment: what is run in it.

    Raises:
        ExperimentError: it holds a run of another experiment, or other files.
    """

    def __init__(self, path: Path, experiment: Experiment) -> None:
        self.path = path
        self._recordings = path / "recordings"
        resolved = dump_experiment(experiment)
        file = path / EXPERIMENT_FILE
        if file.exists():
            if file.read_text(encoding="utf-8") != resolved:
                mend = "choose another folder, or run the experiment that is in it"
                raise ExperimentError("holds a run of another experiment", where=str(path), mend=mend)
        elif path.exists() and any(path.iterdir()):
            raise ExperimentError(
                "is not empty and holds no run", where=str(path), mend="choose another folder"
            )
        self._recordings.mkdir(parents=True, exist_ok=True)
        file.write_text(resolved, encoding="utf-8")

    def finished(self, name: str) -> bool:
        """Whether a recording is complete."""
        return self._path(name).exists()

    def begun(self, name: str, columns: Sequence[str]) -> list[dict[str, str]]:
        """The whole rows of a recording of numbers that is under way; none if it was not begun.

        Raises:
            ExperimentError: it holds something else than rows of these columns.
        """
        partial = self._path(name).with_suffix(f".csv{_PART}")
        if not partial.exists():
            return []
        try:
            lines = partial.read_text(encoding="utf-8").splitlines(keepends=True)
            rows = list(csv.DictReader(line for line in lines if line.endswith("\n")))
            for row in rows:
                _check_numbers(row, columns)
        except (ValueError, csv.Error) as error:
            mend = "delete it; this recording is then begun anew"
            raise ExperimentError("is damaged", where=str(partial), mend=mend) from error
        return rows

    def write(self, name: str, columns: Sequence[str], kept: Sequence[Mapping[str, str]] = ()) -> RowWriter:
        """Begin a recording, with rows of an earlier attempt that are kept."""
        return RowWriter(self._path(name), tuple(columns), kept)

    def read(self, name: str) -> Recording:
        """A complete recording.

        Raises:
            RecordingError: it is no recording (docs/formats.md#recordings).
        """
        return read_recording(self._path(name))

    def _path(self, name: str) -> Path:
        return self._recordings / f"{name}.csv"


@final
class RowWriter:
    """Writes one recording row by row; a context manager. Every row is on disk when `append` comes back.

    Args:
        path: the complete recording's path.
        columns: of docs/formats.md#recordings.
        kept: rows to begin with.

    Attributes:
        path: as given.
    """

    def __init__(self, path: Path, columns: tuple[str, ...], kept: Sequence[Mapping[str, str]]) -> None:
        self.path = path
        self._partial = path.with_suffix(f".csv{_PART}")
        self._columns = columns
        self._file: TextIO = self._partial.open("w", encoding="utf-8", newline="")
        self._file.write(",".join(columns) + "\n")
        for row in kept:
            self._file.write(",".join(row[name] for name in columns) + "\n")
        self._file.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def append(self, row: IndexRow) -> None:
        """Write one row; columns that it leaves out are empty cells."""
        self._file.write(",".join(_cell(row.get(name)) for name in self._columns) + "\n")
        self._file.flush()

    def finish(self) -> None:
        """The recording is complete."""
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        self._partial.replace(self.path)


def _check_numbers(row: Mapping[str, str | None], columns: Sequence[str]) -> None:
    """Refuse, as a ValueError, a row that has other columns, or a cell that is no finite number."""
    if set(row) != set(columns) or not all(cell and math.isfinite(float(cell)) for cell in row.values()):
        raise ValueError("not a row of numbers")


def _cell(value: float | str | None) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else f"{value:.10g}"
