"""Arrow's numbers as an array, without pandas: pyarrow's own conversions import it wherever it is installed."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from nxt_twin.arrays import FloatArray


def floats(column: pa.ChunkedArray) -> FloatArray:
    """The numbers of a column, shape (rows,); nulls are NaN.

    Raises:
        pyarrow.ArrowInvalid: a cell is no number.
    """
    chunks = column.cast(pa.float64(), safe=False).chunks
    return np.concatenate([np.empty(0), *map(_of_chunk, chunks)])


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
