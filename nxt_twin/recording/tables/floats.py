"""Arrow's cells from and to arrays, without pandas: pyarrow's own conversions import it wherever it is installed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from nxt_twin.arrays import BoolArray, FloatArray, IntArray


def floats(column: pa.ChunkedArray) -> FloatArray:
    """The numbers of a column, shape (rows,); nulls are NaN.

    Raises:
        pyarrow.ArrowInvalid: a cell is no number.
    """
    # A cast imports pyarrow.compute, a tenth of the time in which `simulate` starts.
    ready = column if column.type == pa.float64() else column.cast(pa.float64(), safe=False)
    return np.concatenate([np.empty(0), *map(_of_chunk, ready.chunks)])


def arrow_numbers(values: FloatArray | IntArray, empty: BoolArray) -> pa.Array:
    """A column of 64-bit numbers, null where `empty`; both have shape (rows,)."""
    kind = pa.from_numpy_dtype(values.dtype)
    return pa.Array.from_buffers(kind, values.size, [_known(empty), pa.py_buffer(values)], int(empty.sum()))


def arrow_words(words: Sequence[str], which: IntArray, empty: BoolArray) -> pa.Array:
    """A column of text: in each row the word of that number, null where `empty`; both have shape (rows,)."""
    encoded = [word.encode() for word in words]
    sizes = np.array([len(word) for word in encoded])[which]
    ends = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)
    letters = b"".join(encoded[number] for number in which)
    cells = [_known(empty), pa.py_buffer(ends), pa.py_buffer(letters)]
    return pa.Array.from_buffers(pa.string(), which.size, cells, int(empty.sum()))


def _known(empty: BoolArray) -> pa.Buffer | None:
    return pa.py_buffer(np.packbits(~empty, bitorder="little")) if empty.any() else None


def _of_chunk(chunk: pa.Array) -> FloatArray:
    if len(chunk) == chunk.null_count:
        return np.full(len(chunk), np.nan)
    rows = slice(chunk.offset, chunk.offset + len(chunk))
    is_known, values = chunk.buffers()
    found: FloatArray = np.frombuffer(values, dtype=np.float64, count=rows.stop)[rows]
    if is_known is None:
        return found
    bits = np.unpackbits(np.frombuffer(is_known, dtype=np.uint8), bitorder="little")[rows]
    return np.where(bits, found, np.nan)
