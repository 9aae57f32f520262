"""MAT files up to version 7, each variable a column."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nxt_twin.arrays import FloatArray
from nxt_twin.errors import NxtTwinError, RecordingError
from nxt_twin.recording.source import read_table_head
from nxt_twin.recording.tables.table import LARGEST_CELLS, Choose, Table

_HDF5_SIGNATURE = b"\x89HDF\r\n"
_HDF5_OFFSETS = (0, 512)


def read_mat(path: Path, choose: Choose) -> Table:
    """Read the chosen variables of a MAT file; NaN is an empty cell.

    Raises:
        RecordingError: if the file is no MAT file of version 7 or less, or a chosen variable is no vector of
            real numbers, or they differ in length. `choose` may raise its own.
    """
    head = read_table_head(path, RecordingError)
    if any(head.startswith(_HDF5_SIGNATURE, offset) for offset in _HDF5_OFFSETS):
        mend = "save it with save(…, '-v7')"
        raise RecordingError("is a MAT file of version 7.3, which is not read", where=str(path), mend=mend)
    numbers = {name: _vector(values, path, name) for name, values in _load(path, choose).items()}
    lengths = {name: values.size for name, values in numbers.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
        mend = "map variables of one length"
        raise RecordingError(f"its variables differ in length: {listed}", where=str(path), mend=mend)
    return Table(numbers, {}, lambda index, name: f"{path}, row {index + 1}, column {name}")


def _load(path: Path, choose: Choose) -> Mapping[str, Any]:
    from scipy.io import loadmat, whosmat  # only here: importing it takes longer than reading most recordings

    try:
        shapes = {name: shape for name, shape, _ in whosmat(path, appendmat=False)}
        wanted = choose(list(shapes))
        if sum(prod(shapes[name]) for name in wanted) > LARGEST_CELLS:
            mend = "split it into shorter recordings"
            raise RecordingError("its variables are too large", where=str(path), mend=mend)
        variables = loadmat(path, appendmat=False, variable_names=list(wanted))
        return {name: variables[name] for name in wanted}
    except NxtTwinError:
        raise
    except Exception as failure:  # a damaged file makes the parser fail in any way it can
        mend = "check that the file is whole"
        raise RecordingError(f"is no readable MAT file: {failure}", where=str(path), mend=mend) from None


def _vector(values: NDArray[Any], path: Path, name: str) -> FloatArray:
    is_real = values.dtype.kind in "biuf"
    is_vector = values.ndim <= 1 or sum(length > 1 for length in values.shape) <= 1
    if not (is_real and is_vector):
        what = f"is {values.dtype} of shape {values.shape}, not a vector of numbers"
        raise RecordingError(what, where=f"{path}, column {name}", mend="map a vector")
    return values.astype(np.float64).ravel()
