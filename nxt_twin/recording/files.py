"""Recordings on disk: CSV or Parquet by suffix, with an optional sidecar."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pyarrow as pa
import pyarrow.csv

from nxt_twin.errors import RecordingError
from nxt_twin.recording.arrow import table_of
from nxt_twin.recording.checks import checked_columns
from nxt_twin.recording.columns import CATALOGUE, check_names, mapping_advice
from nxt_twin.recording.lags import KnownLags
from nxt_twin.recording.pulses import known_pulse_steps
from nxt_twin.recording.recording import Recording
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.lines import TextLayout
from nxt_twin.recording.tables.parquet import read_parquet
from nxt_twin.recording.tables.table import CellKind, Choose, Table
from nxt_twin.recording.tables.text import read_text
from nxt_twin.recording.tacho_steps import known_tacho_steps
from nxt_twin.recording.yaml_file import read_yaml

_READERS: Mapping[str, Callable[[Path, Choose], Table]] = MappingProxyType(
    {".csv": lambda path, choose: read_text(path, TextLayout(), choose), ".parquet": read_parquet}
)


def read_recording(path: Path) -> Recording:
    """Read a recording, and the plant, the lags and the bridge's steps that its sidecar tells.

    Commands that a row leaves empty are filled in with the one in force.

    Raises:
        RecordingError: if the file, its sidecar, or anything in them is not as docs/formats.md says.
    """
    read_table_head(path, RecordingError)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        mend = mapping_advice(path)
        raise RecordingError("is neither .csv nor .parquet", where=str(path), mend=mend)

    def choose(names: Sequence[str]) -> Mapping[str, CellKind]:
        check_names(names, path)
        return {name: "word" if CATALOGUE[name].words else "number" for name in names}

    columns = checked_columns(reader(path, choose), path)
    sidecar = read_sidecar(path)
    plant = sidecar.get("plant")
    named = plant if isinstance(plant, str) else None
    where = str(path.with_suffix(".yaml"))
    return Recording(
        path.name,
        columns,
        plant=named,
        lags=KnownLags(sidecar, where),
        tacho_step_deg=known_tacho_steps(sidecar, where),
        pulse_steps=known_pulse_steps(sidecar, where),
    )


def read_sidecar(path: Path) -> dict[str, Any]:
    """Read the free keys of `NAME.yaml` beside the recording `NAME.csv`; none without a sidecar.

    Raises:
        RecordingError: if there is a sidecar that is no YAML, or its `plant` is neither a name nor keys.
    """
    if not path.name:
        return {}
    sidecar = path.with_suffix(".yaml")
    if not sidecar.exists():
        return {}
    keys = read_yaml(sidecar, RecordingError)
    if not isinstance(keys.get("plant", ""), str | dict):
        where = f"{sidecar}, key plant"
        raise RecordingError("is no plant", where=where, mend="name a plant configuration")
    return keys


def write_recording(recording: Recording, path: Path, *, anew: bool = False) -> None:
    """Write a recording's columns as CSV or Parquet, by suffix; never leaves half a file behind.

    NaN becomes an empty cell. Columns of whole numbers become integers, and modes become words. All other
    numbers get every digit that an exact reading back needs. The sidecar is the user's, and is not written. The
    `kinds` and `output_quantum` of a mapped recording stand in its mapping file.

    Args:
        recording: to be written.
        path: where to.
        anew: nothing that is there is written over, and it is on the disk itself when this comes back.

    Raises:
        RecordingError: if the suffix is another, the file cannot be written, or (`anew`) it is there already.
    """
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        raise RecordingError("is neither .csv nor .parquet", where=str(path), mend="change the suffix")
    table = table_of(recording.columns)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        if suffix == ".csv":
            _write_csv(table, partial)
        else:
            from pyarrow import parquet  # slow, and a text table needs none of it

            parquet.write_table(table, partial)
        if anew:
            _sync(partial)
            _put_anew(partial, path)
            _sync(path.parent)
        else:
            partial.replace(path)
    except FileExistsError:
        raise RecordingError("is there already", where=str(path), mend="move it away") from None
    except OSError as failure:
        what = f"cannot be written: {failure.strerror}"
        raise RecordingError(what, where=str(path), mend="check the folder and the space left") from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


def _put_anew(partial: Path, path: Path) -> None:
    """Give a file its name, which must be free; some file systems cannot do both at once."""
    try:
        path.hardlink_to(partial)
    except FileExistsError:
        raise
    except OSError:
        if path.exists():
            raise FileExistsError from None
        partial.replace(path)


def _sync(path: Path) -> None:
    """Wait until a file, or a folder's list of names, is on the disk; Windows cannot open folders."""
    if path.is_dir() and os.name == "nt":
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _write_csv(table: pa.Table, path: Path) -> None:
    options = pyarrow.csv.WriteOptions(include_header=False, quoting_style="none")
    with path.open("wb") as file:
        file.write((",".join(table.column_names) + "\n").encode())
        pyarrow.csv.write_csv(table, file, options)
