"""MAT files up to version 7: each vector a column, `data[3]` one of a matrix, `log.speed` one of a struct."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import prod
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from typing import IO, Any, Final

import numpy as np
from numpy.typing import NDArray

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.nested import element, element_names, innermost, split_name
from nxt_twin.recording.tables.table import Choose, Table, cells_allowed, check_unfolded

_READER: Final = Path(__file__).with_name("mat_reader.py")
_CELL_BYTES: Final = 8
_HDF5_SIGNATURE = b"\x89HDF\r\n"
_HDF5_OFFSETS = (0, 512)


def read_mat(path: Path, choose: Choose) -> Table:
    """Read the chosen variables of a MAT file; NaN is an empty cell.

    Raises:
        RecordingError: the file is no MAT file of version 7 or less. Or a chosen variable is no vector of real numbers,
            or the variables differ in length. `choose` may raise its own.
    """
    head = read_table_head(path, RecordingError)
    if any(head.startswith(_HDF5_SIGNATURE, offset) for offset in _HDF5_OFFSETS):
        mend = "save it with save(…, '-v7')"
        raise RecordingError("is a MAT file of version 7.3, which is not read", where=str(path), mend=mend)
    numbers = {name: _column(values, path, name) for name, values in _load(path, choose).items()}
    lengths = {name: values.size for name, values in numbers.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
        mend = "map variables of one length"
        raise RecordingError(f"its variables differ in length: {listed}", where=str(path), mend=mend)
    return Table(numbers, {}, lambda index, name: f"{path}, row {index + 1}, column {name}")


def read_vectors(path: Path) -> dict[str, FloatArray]:
    """Every vector of numbers in a MAT file, by its full name, of whatever length.

    Raises:
        RecordingError: the file is no MAT file of version 7 or less, or unfolds to too much.
    """
    found: dict[str, FloatArray] = {}
    for name, values in _load(
        path, lambda names: dict.fromkeys(innermost(names), "number"), all_kinds=True
    ).items():
        with suppress(RecordingError):
            found[name] = _column(values, path, name)
    return found


def _load(path: Path, choose: Choose, *, all_kinds: bool = False) -> Mapping[str, NDArray[Any]]:
    """The chosen variables, read by a program of its own: a damaged byte can end scipy's reader, and who runs it."""
    most_bytes = 3 * _CELL_BYTES * cells_allowed(path)
    command = [sys.executable, "-P", str(_READER), str(path), str(most_bytes)]
    with subprocess.Popen(command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL) as reader:  # noqa: S603 - our own
        try:
            shapes = {name: tuple(shape) for name, shape in _told(reader, path)["shapes"].items()}
            wanted = list(choose(_offered(shapes)))
            held = list(dict.fromkeys(_holder(name, shapes) for name in wanted))
            check_unfolded(sum(prod(shapes[name]) for name in held), path)
            variables = {name: _variable(reader, held, path, name) for name in held}
            if not all_kinds:
                for name, values in variables.items():
                    _refuse_other_kind(values, path, name)
            return {name: _part(variables, name, shapes) for name in wanted}
        finally:
            reader.kill()


def _offered(shapes: Mapping[str, tuple[int, ...]]) -> list[str]:
    return [each for name, shape in shapes.items() for each in (name, *element_names(name, shape))]


def _holder(name: str, shapes: Mapping[str, tuple[int, ...]]) -> str:
    """The variable in which a column is."""
    return name if name in shapes else split_name(name)[0]


def _part(
    variables: Mapping[str, NDArray[Any]], name: str, shapes: Mapping[str, tuple[int, ...]]
) -> NDArray[Any]:
    if name in shapes:
        return variables[name]
    stem, index = split_name(name)
    return element(variables[stem], index or 0)


def _variable(reader: Popen[bytes], wanted: Sequence[str], path: Path, name: str) -> NDArray[Any]:
    """The next variable that the reader sends once it knows which are wanted; of what is no numbers, its kind."""
    if name == wanted[0]:
        _ask(reader, wanted)
    told = _told(reader, path)
    if "kind" in told:
        return np.array(str(told["kind"]))
    shape, kind = tuple(told["shape"]), np.dtype(told["dtype"])
    data = _output(reader).read(prod(shape) * kind.itemsize)
    if len(data) < prod(shape) * kind.itemsize:
        raise _unreadable(path, "its reader came to an end")
    return np.frombuffer(data, dtype=kind).reshape(shape)


def _refuse_other_kind(values: NDArray[Any], path: Path, name: str) -> None:
    if values.dtype.kind == "U":
        what = f"is {values}, not a vector of numbers"
        raise RecordingError(what, where=f"{path}, column {name}", mend="map a vector")


def _ask(reader: Popen[bytes], wanted: Sequence[str]) -> None:
    if reader.stdin is not None:
        with suppress(OSError):  # a reader that has ended is told of when it is listened to
            reader.stdin.write(json.dumps(wanted).encode() + b"\n")
            reader.stdin.flush()


def _told(reader: Popen[bytes], path: Path) -> dict[str, Any]:
    """The reader's next line."""
    try:
        told = json.loads(_output(reader).readline())
    except ValueError:
        raise _unreadable(path, "its reader came to an end") from None
    if "error" in told:
        raise _unreadable(path, str(told["error"]))
    return dict(told)


def _output(reader: Popen[bytes]) -> IO[bytes]:
    if reader.stdout is None:
        raise ValueError("the reader was opened without an output")
    return reader.stdout


def _unreadable(path: Path, why: str) -> RecordingError:
    mend = "check that the file is whole"
    return RecordingError(f"is no readable MAT file: {why}", where=str(path), mend=mend)


def _column(values: NDArray[Any], path: Path, name: str) -> FloatArray:
    is_real = values.dtype.kind in "biuf"
    is_vector = values.ndim <= 1 or sum(length > 1 for length in values.shape) <= 1
    if not (is_real and is_vector):
        what = f"is {values.dtype} of shape {values.shape}, not a vector of numbers"
        mend = f"write {{column: {name}, index: 0}}" if values.ndim == 2 else "map a vector"
        raise RecordingError(what, where=f"{path}, column {name}", mend=mend)
    return values.astype(np.float64).ravel()
